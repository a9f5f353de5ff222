// SPDX-License-Identifier: Apache-2.0
// Gazepoint Analysis, `User N_all_gaze.csv`: TIME(date) in seconds from the start of the recording or of each medium,
// TIMETICK(f=10000000) in ticks of the frequency that its name states. BPOG, the best point of gaze, and LPOG and RPOG
// of each eye are fractions of the screen from the top left, with a validity of 0 or 1. A lost point keeps its last
// value. FPOG is the running mean of a fixation, which is smoother than BPOG: FPOGID counts the fixations, FPOGS says
// when one began and FPOGD how long it has lasted so far, both in seconds. FPOGV is 1 only from the row on in which the
// fixation was recognized, so that runs of it begin late. LPMM and RPMM are diameters of the pupils in millimetres,
// with LPMMV and RPMMV; LPD and RPD, with LPV and RPV, in pixels of the camera's picture. AOI names the area of
// interest under the gaze. Every line ends with a comma. (Gazepoint API and Gazepoint Analysis manuals.)
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

RawGaze read_gaze_gazepoint(const GazeFile& file, const GazeReadOptions& options);

namespace {

struct Pupil {
  std::optional<std::size_t> size, valid;
};

struct Point {
  Eye eye = Eye::cyclopean;
  std::size_t x = 0, y = 0;
  std::optional<std::size_t> valid;
};

// The pupils of the left and the right eye, in one unit.
struct Pupils {
  std::array<Pupil, 2> eyes;
  std::string unit;

  // Of one eye; of both, the mean of those that were measured. NaN where there is none.
  [[nodiscard]] double of(TableRows& rows, Eye eye) const {
    double sum = 0;
    double count = 0;
    for (const Eye side : {Eye::left, Eye::right}) {
      const Pupil& pupil = eyes[side == Eye::left ? 0 : 1];
      const double size = rows.number(pupil.size);
      const bool is_measured = size > 0 && (!pupil.valid || rows.number(*pupil.valid) == 1);
      if (is_measured && (eye == side || eye == Eye::cyclopean)) {
        sum += size;
        ++count;
      }
    }
    return count > 0 ? sum / count : kNan;
  }
};

Pupils find_pupils(const DelimitedTable& table, RawGaze& raw) {
  Pupils pupils;
  const auto has = [&](const char* name) { return table.find(name).has_value(); };
  const bool in_mm = has("LPMM") || has("RPMM");
  if (in_mm) {
    pupils = {{{{table.find("LPMM"), table.find("LPMMV")}, {table.find("RPMM"), table.find("RPMMV")}}}, "mm"};
    add_note(raw, "pupil columns", "LPMM, RPMM", Evidence::header,
             has("LPD") || has("RPD") ? "LPD and RPD, in pixels of the camera, are left out" : "");
  } else if (has("LPD") || has("RPD")) {
    pupils = {{{{table.find("LPD"), table.find("LPV")}, {table.find("RPD"), table.find("RPV")}}}, "px"};
    add_note(raw, "pupil columns", "LPD, RPD", Evidence::header, "diameters in pixels of the camera");
  }
  return pupils;
}

// The fixations that the log states. A fixation's last row has its whole duration.
class StatedFixations {
 public:
  StatedFixations(const DelimitedTable& table, std::optional<std::size_t> seconds, std::size_t time,
                  const TimeScale& scale)
      : id_(table.find("FPOGID")),
        start_(table.find("FPOGS")),
        duration_(table.find("FPOGD")),
        seconds_(seconds),
        time_(time),
        scale_(scale) {}

  [[nodiscard]] bool are_stated() const { return id_ && start_ && duration_ && seconds_; }
  [[nodiscard]] std::size_t needed_cells() const {
    return are_stated() ? std::max({*id_, *start_, *duration_, *seconds_}) + 1 : 0;
  }

  void read(TableRows& rows, std::int64_t t_ns) {
    const double length_s = rows.number(*duration_);
    if (!(length_s > 0) || is_missing(rows.cell(*start_)) || is_missing(rows.cell(*seconds_))) {
      return;
    }
    if (open_.empty() || rows.cell(*id_) != open_) {
      events_.push_back({GazeEventType::fixation, Eye::cyclopean, 0, 0, {}, rows.line()});
      open_ = rows.cell(*id_);
    }
    // FPOGS counts from where TIME does, whatever column the stamps are taken from.
    const TimeScale in_seconds{seconds_ == time_ ? scale_.exponent : 9, 0};
    std::int64_t ago_ns = 0;
    std::int64_t length_ns = 0;
    GazeEvent& event = events_.back();
    const bool fits =
        !__builtin_sub_overflow(rows.time_ns(*seconds_, in_seconds), rows.time_ns(*start_, in_seconds), &ago_ns) &&
        scaled_integer(rows.cell(*duration_), in_seconds.exponent, length_ns) == NumberStatus::ok &&
        !__builtin_sub_overflow(t_ns, ago_ns, &event.begin_ns) &&
        !__builtin_add_overflow(event.begin_ns, length_ns, &event.end_ns);
    if (!fits) {
      rows.fail("the fixation's begin (FPOGS) or duration (FPOGD) does not fit the row's time", "mend the row");
    }
    event.stated_duration_ns = length_ns;
  }
  void begin_anew() { open_.clear(); }
  void finish(RawGaze& raw) const { raw.events.insert(raw.events.end(), events_.begin(), events_.end()); }

 private:
  std::optional<std::size_t> id_, start_, duration_, seconds_;
  std::size_t time_;
  TimeScale scale_;
  std::string open_;
  std::vector<GazeEvent> events_;
};

std::optional<std::size_t> column_starting(const DelimitedTable& table, std::string_view prefix) {
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    const std::string& text = table.headings[i].text;
    if (text.starts_with(prefix) &&
        (text.size() == prefix.size() || text[prefix.size()] == '(' || text[prefix.size()] == ' ')) {
      return i;
    }
  }
  return std::nullopt;
}

std::vector<Point> find_points(const DelimitedTable& table, const std::string& place) {
  std::vector<Point> points;
  for (const auto& [stem, eye] :
       {std::pair("BPOG", Eye::cyclopean), std::pair("LPOG", Eye::left), std::pair("RPOG", Eye::right)}) {
    const auto x = table.find(fmt::format("{}X", stem));
    const auto y = table.find(fmt::format("{}Y", stem));
    if (x && y) {
      points.push_back({eye, *x, *y, table.find(fmt::format("{}V", stem))});
    }
  }
  if (points.empty()) {
    const bool fixations = table.find("FPOGX").has_value();
    throw Error(ErrorKind::input, place,
                fixations ? "there is only FPOG, the mean of the fixation so far" : "there is no point of gaze (BPOGX)",
                "export all gaze with BPOG, or read FPOGX and FPOGY by `gaze-format` generic with "
                "`gaze-x-column` and `gaze-y-column`");
  }
  return points;
}

// TIMETICK(f=10000000): the frequency as a power of ten, or nothing.
std::optional<int> tick_exponent(const ColumnHeading& heading) {
  const std::size_t equals = heading.unit.find('=');
  const std::string digits = equals == std::string::npos ? "" : heading.unit.substr(equals + 1);
  if (!digits.starts_with('1') || digits.find_first_not_of('0', 1) != std::string::npos || digits.size() > 10) {
    return std::nullopt;
  }
  return 9 - static_cast<int>(digits.size() - 1);
}

// Reads a log whose TIME starts anew by the ticks of the computer, which go on. That is another time than the one that
// was asked for, so it is reported as a fault.
RawGaze read_by_ticks(const GazeFile& file, const GazeReadOptions& options, const std::string& time,
                      const std::string& ticks, std::int64_t line) {
  GazeReadOptions by_ticks = options;
  by_ticks.columns.time = ticks;
  RawGaze raw = read_gaze_gazepoint(file, by_ticks);
  raw.faults.push_back({"media", place_of(file, line), fmt::format("{} starts anew with another medium", time),
                        fmt::format("use `gaze-time-column` {}, which goes on, or export one medium a file", ticks),
                        "`gaze-time-column` " + ticks,
                        fmt::format("line {}: TIME starts anew with another medium", line)});
  return raw;
}

}  // namespace

double sniff_gaze_gazepoint(const GazeFile& file) {
  const std::string_view head = head_of(file, 8192);
  const std::string_view line = head.substr(0, head.find('\n'));
  const auto has = [&](std::string_view text) { return line.find(text) != std::string_view::npos; };
  return has("BPOGX") || has("FPOGX") ? has("TIME") ? 0.99 : 0.7 : 0.0;
}

RawGaze read_gaze_gazepoint(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const std::string place = place_of(file, table.header_line);
  const auto seconds = column_starting(table, "TIME");
  const auto ticks = column_starting(table, "TIMETICK");
  if (!seconds && !ticks && options.columns.time.empty()) {
    throw Error(ErrorKind::input, place, "there is no column TIME(...)", "name it with `gaze-time-column`");
  }
  RawGaze raw;
  raw.source = file.path;
  raw.format = "gazepoint";
  const Pupils pupils = find_pupils(table, raw);
  raw.pupil_unit = pupils.unit;
  raw.clock = "recording, from its start";
  const std::size_t time = time_column(table, options, seconds ? *seconds : ticks.value_or(0), place);
  const bool is_tick = ticks && time == *ticks;
  const auto tick = is_tick ? tick_exponent(table.headings[time]) : std::nullopt;
  const std::vector<Point> points = find_points(table, place);
  const auto blink = table.find("BKID");
  const auto media = table.find("MEDIA_ID");
  const auto fixation = table.find("FPOGID");
  const auto fixation_valid = table.find("FPOGV");
  const auto aoi = table.find("AOI");
  // The date in the header is the wall clock of the start, and is not kept.
  const TimeScale scale = declare_time(raw, options,
                                       is_tick                       ? "TIMETICK"
                                       : seconds && time == *seconds ? "TIME"
                                                                     : table.headings[time].text,
                                       tick.value_or(9), Evidence::format, place);
  StatedFixations fixations(table, seconds, time, scale);
  std::size_t needed = std::max({time, blink.value_or(0), media.value_or(0), fixation.value_or(0),
                                 fixation_valid.value_or(0), aoi.value_or(0)}) +
                       1;
  needed = std::max(needed, fixations.needed_cells());
  for (const Pupil& pupil : pupils.eyes) {
    needed = std::max({needed, pupil.size.value_or(0) + 1, pupil.valid.value_or(0) + 1});
  }
  for (const Point& point : points) {
    needed = std::max({needed, point.x + 1, point.y + 1, point.valid.value_or(0) + 1});
  }
  LabelRuns runs;
  LabelRuns areas;
  std::string medium;
  std::int64_t last = 0;
  TableRows rows(file, table, needed);
  while (rows.next()) {
    rows.check_length();
    const std::int64_t t_ns = rows.time_ns(time, scale);
    if (media && rows.cell(*media) != medium) {
      if (!raw.rows.empty() && t_ns < last) {
        const std::string ticks_name = ticks && !is_tick ? table.headings[*ticks].name : "";
        const std::string& time_name = table.headings[time].name;
        if (!ticks_name.empty()) {
          return read_by_ticks(file, options, time_name, ticks_name, rows.line());
        }
        rows.fail(fmt::format("{} starts anew with another medium", time_name), "export one medium a file");
      }
      medium = rows.cell(*media);
      fixations.begin_anew();
      raw.events.push_back({GazeEventType::message, Eye::cyclopean, t_ns, t_ns, "medium " + medium, rows.line()});
    }
    last = t_ns;
    const bool blinks = blink && rows.number(*blink) > 0;
    for (const Point& point : points) {
      RawSample sample = position_row(t_ns, rows.line(), point.eye, {rows.number(point.x), rows.number(point.y)},
                                      pupils.of(rows, point.eye));
      const bool good = !point.valid || rows.number(*point.valid) == 1;
      sample.validity = blinks ? GazeValidity::blink : good ? sample.validity : GazeValidity::lost;
      raw.rows.push_back(sample);
    }
    if (fixations.are_stated()) {
      fixations.read(rows, t_ns);
    } else if (fixation && fixation_valid && rows.number(*fixation_valid) == 1) {
      runs.add(GazeEventType::fixation, Eye::cyclopean, std::string(rows.cell(*fixation)), t_ns, rows.line());
    } else {
      runs.end();
    }
    if (const std::string_view area = rows.cell(aoi); !is_missing(area)) {
      areas.add(GazeEventType::aoi, Eye::cyclopean, area, t_ns, rows.line(), area);
    } else {
      areas.end();
    }
  }
  runs.finish(raw);
  fixations.finish(raw);
  areas.finish(raw);
  declare_places(raw,
                 {PositionUnit::fraction, PositionOrigin::top_left, Evidence::format,
                  table.headings[points.front().x].text + ", " + table.headings[points.front().y].text},
                 place);
  return raw;
}

}  // namespace gazetrace
