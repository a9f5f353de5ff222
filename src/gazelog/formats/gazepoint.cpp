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

#include "core/text.hpp"
#include "gazelog/gazepoint_columns.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

RawGaze read_gaze_gazepoint(const GazeFile& file, const GazeReadOptions& options);

namespace {

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
                         const GazepointColumns& c, const std::string& place) {
  const ColumnHeading& heading = table.headings[c.time];
  const auto tick = c.is_by_ticks() ? tick_exponent(heading) : std::nullopt;
  const std::string name = c.is_by_ticks() ? "TIMETICK" : c.seconds == c.time ? "TIME" : heading.text;
  return declare_time(raw, options, name, tick.value_or(9), Evidence::format, place);
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

// Of a log that counts the fixations and does not say when they began.
void label_fixation(LabelRuns& runs, TableRows& rows, const GazepointColumns& c, std::int64_t t_ns) {
  if (c.fixation && c.fixation_valid && rows.number(*c.fixation_valid) == 1) {
    runs.add(GazeEventType::fixation, Eye::cyclopean, rows.cell(*c.fixation), t_ns, rows.line());
  } else {
    runs.end();
  }
}

void label_area(LabelRuns& areas, TableRows& rows, const GazepointColumns& c, std::int64_t t_ns) {
  if (const std::string_view area = rows.cell(c.aoi); !is_missing(area)) {
    areas.add(GazeEventType::aoi, Eye::cyclopean, area, t_ns, rows.line(), area);
  } else {
    areas.end();
  }
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
  const GazepointColumns c = find_gazepoint_columns(table, options, place);
  RawGaze raw;
  raw.source = file.path;
  raw.format = "gazepoint";
  raw.clock = "recording, from its start";
  raw.pupil_unit = c.pupils.unit;
  if (!c.pupils.columns.empty()) {
    add_note(raw, "pupil columns", c.pupils.columns, Evidence::header, c.pupils.detail);
  }
  const TimeScale scale = declare_stamps(raw, options, table, c, place);
  StatedFixations fixations(c, scale);
  LabelRuns runs;
  LabelRuns areas;
  std::string medium;
  std::int64_t last_ns = 0;
  TableRows rows(file, table, needed_cells(c));
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
    } else {
      label_fixation(runs, rows, c, t_ns);
    }
    label_area(areas, rows, c, t_ns);
  }
  runs.finish(raw);
  fixations.finish(raw);
  areas.finish(raw);
  declare_places(raw,
                 {PositionUnit::fraction, PositionOrigin::top_left, Evidence::format,
                  table.headings[c.points.front().x].text + ", " + table.headings[c.points.front().y].text},
                 place);
  return raw;
}

}  // namespace gazetrace
