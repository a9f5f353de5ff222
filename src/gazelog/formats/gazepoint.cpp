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

#include <array>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

RawGaze read_gaze_gazepoint(const GazeFile& file, const GazeReadOptions& options);

namespace {

// The pupils of the left and the right eye, in one unit.
struct GazepointPupils {
  struct Columns {
    OptionalColumn size, valid;
  };
  std::array<Columns, 2> eyes;
  std::string unit, columns, detail;  // the last two in words; all are empty where there are no pupils

  // Of one eye; of both, the mean of those that were measured. NaN where there is none.
  [[nodiscard]] double of(TableRows& rows, Eye eye) const;
};

struct GazepointPoint {
  Eye eye = Eye::cyclopean;
  std::size_t x = 0, y = 0;
  OptionalColumn valid;
};

struct GazepointColumns {
  OptionalColumn seconds, ticks;  // TIME, TIMETICK
  std::size_t time = 0;           // the one of the stamps
  GazepointPupils pupils;
  std::vector<GazepointPoint> points;
  OptionalColumn blink, media, aoi;
  OptionalColumn fixation, fixation_valid, fixation_start, fixation_duration;

  [[nodiscard]] bool is_by_ticks() const { return ticks && time == *ticks; }
  [[nodiscard]] bool state_fixations() const { return fixation && fixation_start && fixation_duration && seconds; }
};

double GazepointPupils::of(TableRows& rows, Eye eye) const {
  double sum = 0;
  double count = 0;
  for (const Eye side : {Eye::left, Eye::right}) {
    const GazepointPupils::Columns& pupil = eyes[side == Eye::left ? 0 : 1];
    const double size = rows.number(pupil.size);
    const bool is_measured = size > 0 && (!pupil.valid || rows.number(*pupil.valid) == 1);
    if (is_measured && (eye == side || eye == Eye::cyclopean)) {
      sum += size;
      ++count;
    }
  }
  return count > 0 ? sum / count : kNan;
}

GazepointPupils find_pupils(const DelimitedTable& table, UsedColumns& used) {
  const auto has = [&](const char* name) { return table.find(name).has_value(); };
  const bool in_mm = has("LPMM") || has("RPMM");
  const bool in_px = has("LPD") || has("RPD");
  if (!in_mm && !in_px) {
    return {};
  }
  const std::string of_eye = in_mm ? "PMM" : "PD";
  const std::string valid = in_mm ? "PMMV" : "PV";
  return {{{{used.find("L" + of_eye), used.find("L" + valid)}, {used.find("R" + of_eye), used.find("R" + valid)}}},
          in_mm ? "mm" : "px",
          fmt::format("L{0}, R{0}", of_eye),
          !in_mm  ? "diameters in pixels of the camera"
          : in_px ? "LPD and RPD, in pixels of the camera, are left out"
                  : ""};
}

OptionalColumn column_starting(const DelimitedTable& table, std::string_view prefix) {
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    const std::string& text = table.headings[i].text;
    if (text.starts_with(prefix) &&
        (text.size() == prefix.size() || text[prefix.size()] == '(' || text[prefix.size()] == ' ')) {
      return i;
    }
  }
  return std::nullopt;
}

std::vector<GazepointPoint> find_points(const DelimitedTable& table, UsedColumns& used) {
  std::vector<GazepointPoint> points;
  for (const auto& [stem, eye] :
       {std::pair("BPOG", Eye::cyclopean), std::pair("LPOG", Eye::left), std::pair("RPOG", Eye::right)}) {
    const auto x = table.find(fmt::format("{}X", stem));
    const auto y = table.find(fmt::format("{}Y", stem));
    if (x && y) {
      points.push_back({eye, *used.use(x), *used.use(y), used.find(fmt::format("{}V", stem))});
    }
  }
  if (points.empty()) {
    const bool fixations = table.find("FPOGX").has_value();
    throw Error(ErrorKind::input, table.place,
                fixations ? "there is only FPOG, the mean of the fixation so far" : "there is no point of gaze (BPOGX)",
                "export all gaze with BPOG, or read FPOGX and FPOGY by `format` generic with "
                "`x-column` and `y-column`");
  }
  return points;
}

GazepointColumns find_gazepoint_columns(const DelimitedTable& table, const GazeReadOptions& options,
                                        UsedColumns& used) {
  GazepointColumns c;
  c.seconds = column_starting(table, "TIME");
  c.ticks = column_starting(table, "TIMETICK");
  if (!c.seconds && !c.ticks && options.columns.time.empty()) {
    throw Error(ErrorKind::input, table.place, "there is no column TIME(...)", "name it with `time-column`");
  }
  c.pupils = find_pupils(table, used);
  c.time = used.time(options, c.seconds ? *c.seconds : c.ticks.value_or(0));
  c.points = find_points(table, used);
  c.blink = used.find("BKID");
  c.media = used.find("MEDIA_ID");
  c.fixation = used.find("FPOGID");
  c.fixation_valid = used.find("FPOGV");
  c.aoi = used.find("AOI");
  c.fixation_start = table.find("FPOGS");
  c.fixation_duration = table.find("FPOGD");
  for (const OptionalColumn& column : {c.fixation_start, c.fixation_duration, c.seconds}) {
    used.use(c.state_fixations() ? column : std::nullopt);
  }
  return c;
}

// The fixations that the log states. A fixation's last row has its whole duration.
class StatedFixations {
 public:
  StatedFixations(const GazepointColumns& columns, const TimeScale& scale) : c_(columns), scale_(scale) {}

  void read(TableRows& rows, std::int64_t t_ns) {
    const double length_s = rows.number(*c_.fixation_duration);
    if (!(length_s > 0) || is_missing(rows.cell(*c_.fixation_start)) || is_missing(rows.cell(*c_.seconds))) {
      return;
    }
    if (open_.empty() || rows.cell(*c_.fixation) != open_) {
      events_.push_back({GazeEventType::fixation, Eye::cyclopean, 0, 0, {}, rows.line()});
      open_ = rows.cell(*c_.fixation);
    }
    // FPOGS counts from where TIME does, whatever column the stamps are taken from.
    const TimeScale in_seconds{c_.seconds == c_.time ? scale_.exponent : 9, 0};
    std::int64_t ago_ns = 0;
    std::int64_t length_ns = 0;
    GazeEvent& event = events_.back();
    const bool fits =
        !__builtin_sub_overflow(rows.time_ns(*c_.seconds, in_seconds), rows.time_ns(*c_.fixation_start, in_seconds),
                                &ago_ns) &&
        scaled_integer(rows.cell(*c_.fixation_duration), in_seconds.exponent, length_ns) == NumberStatus::ok &&
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
  const GazepointColumns& c_;
  TimeScale scale_;
  std::string open_;
  std::vector<GazeEvent> events_;
};

// TIMETICK(f=10000000): the frequency as a power of ten, or nothing.
std::optional<int> tick_exponent(const ColumnHeading& heading) {
  const std::size_t equals = heading.unit.find('=');
  const std::string digits = equals == std::string::npos ? "" : heading.unit.substr(equals + 1);
  if (!digits.starts_with('1') || digits.find_first_not_of('0', 1) != std::string::npos || digits.size() > 10) {
    return std::nullopt;
  }
  return 9 - static_cast<int>(digits.size() - 1);
}

// The date in the heading of TIME is the wall clock of the start, and is not kept.
TimeScale declare_stamps(RawGaze& raw, const GazeReadOptions& options, const DelimitedTable& table,
                         const GazepointColumns& c) {
  const ColumnHeading& heading = table.headings[c.time];
  const auto tick = c.is_by_ticks() ? tick_exponent(heading) : std::nullopt;
  const std::string name = c.is_by_ticks() ? "TIMETICK" : c.seconds == c.time ? "TIME" : heading.text;
  return declare_time(raw, options, name, tick.value_or(9), Evidence::format, table.place);
}

// Reads a log whose TIME starts anew, in the row at which `rows` stand, by the ticks of the computer, which go on. That
// is another time than the one that was asked for, so it is reported as a fault.
RawGaze read_by_ticks(const GazeFile& file, const GazeReadOptions& options, const DelimitedTable& table,
                      const GazepointColumns& c, const TableRows& rows) {
  const std::string& time = table.headings[c.time].name;
  const std::string ticks = c.ticks && !c.is_by_ticks() ? table.headings[*c.ticks].name : "";
  if (ticks.empty()) {
    rows.fail(fmt::format("{} starts anew with another medium", time), "export one medium a file");
  }
  GazeReadOptions by_ticks = options;
  by_ticks.columns.time = ticks;
  RawGaze raw = read_gaze_gazepoint(file, by_ticks);
  raw.faults.push_back({"media", place_of(file, rows.line()), fmt::format("{} starts anew with another medium", time),
                        fmt::format("use `time-column` {}, which goes on, or export one medium a file", ticks),
                        "`time-column` " + ticks,
                        fmt::format("line {}: TIME starts anew with another medium", rows.line())});
  return raw;
}

void add_samples(RawGaze& raw, TableRows& rows, const GazepointColumns& c, std::int64_t t_ns) {
  const bool blinks = c.blink && rows.number(*c.blink) > 0;
  for (const GazepointPoint& point : c.points) {
    RawSample sample = position_row(t_ns, rows.line(), point.eye, {rows.number(point.x), rows.number(point.y)},
                                    c.pupils.of(rows, point.eye));
    const bool good = !point.valid || rows.number(*point.valid) == 1;
    sample.validity = blinks ? GazeValidity::blink : good ? sample.validity : GazeValidity::lost;
    raw.rows.push_back(sample);
  }
}

}  // namespace

double sniff_gaze_gazepoint(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  return has("BPOGX") || has("FPOGX") ? has("TIME") ? 0.99 : 0.7 : 0.0;
}

RawGaze read_gaze_gazepoint(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  UsedColumns used(table);
  const GazepointColumns c = find_gazepoint_columns(table, options, used);
  RawGaze raw = raw_of(file, "recording, from its start", c.pupils.unit);
  if (!c.pupils.columns.empty()) {
    add_note(raw, "pupil columns", c.pupils.columns, Evidence::header, c.pupils.detail);
  }
  const TimeScale scale = declare_stamps(raw, options, table, c);
  StatedFixations fixations(c, scale);
  LabelRuns runs;  // of a log that counts the fixations and does not say when they began
  LabelRuns areas;
  std::string medium;
  std::int64_t last_ns = 0;
  TableRows rows(file, table, used.needed());
  while (rows.next()) {
    rows.check_length();
    const std::int64_t t_ns = rows.time_ns(c.time, scale);
    if (c.media && rows.cell(*c.media) != medium) {
      if (!raw.rows.empty() && t_ns < last_ns) {
        return read_by_ticks(file, options, table, c, rows);
      }
      medium = rows.cell(*c.media);
      fixations.begin_anew();
      add_message(raw, t_ns, "medium " + medium, rows.line());
    }
    last_ns = t_ns;
    add_samples(raw, rows, c, t_ns);
    if (c.state_fixations()) {
      fixations.read(rows, t_ns);
    } else if (c.fixation && c.fixation_valid && rows.number(*c.fixation_valid) == 1) {
      runs.add(GazeEventType::fixation, Eye::cyclopean, rows.cell(*c.fixation), t_ns, rows.line());
    } else {
      runs.end();
    }
    if (const std::string_view area = rows.cell(c.aoi); !is_missing(area)) {
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
                  table.headings[c.points.front().x].text + ", " + table.headings[c.points.front().y].text},
                 table.place);
  return raw;
}

}  // namespace gazetrace
