// SPDX-License-Identifier: Apache-2.0
// Gazepoint Analysis, `User N_all_gaze.csv`: TIME(date) in seconds from the start of the recording or of each medium,
// TIMETICK(f=10000000) in ticks of the frequency that its name states. BPOG, the best point of gaze, and LPOG and RPOG
// of each eye are fractions of the screen from the top left, with a validity of 0 or 1. A lost point keeps its last
// value. FPOG is the running mean of a fixation, which is smoother than BPOG. Every line ends with a comma.
#include <fmt/format.h>

#include <algorithm>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

RawGaze read_gaze_gazepoint(const GazeFile& file, const GazeReadOptions& options);

namespace {

struct Point {
  Eye eye = Eye::cyclopean;
  std::size_t x = 0, y = 0;
  std::optional<std::size_t> valid, pupil;
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
  for (const auto& [stem, pupil, eye] : {std::tuple("BPOG", "", Eye::cyclopean), std::tuple("LPOG", "LPD", Eye::left),
                                         std::tuple("RPOG", "RPD", Eye::right)}) {
    const auto x = table.find(fmt::format("{}X", stem));
    const auto y = table.find(fmt::format("{}Y", stem));
    if (x && y) {
      points.push_back({eye, *x, *y, table.find(fmt::format("{}V", stem)), table.find(pupil)});
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
  raw.pupil_unit = "px";
  raw.clock = "recording, from its start";
  const std::size_t time = time_column(table, options, seconds ? *seconds : ticks.value_or(0), place);
  const bool is_tick = ticks && time == *ticks;
  const auto tick = is_tick ? tick_exponent(table.headings[time]) : std::nullopt;
  const std::vector<Point> points = find_points(table, place);
  const auto blink = table.find("BKID");
  const auto media = table.find("MEDIA_ID");
  const auto fixation = table.find("FPOGID");
  const auto fixation_valid = table.find("FPOGV");
  // The date in the header is the wall clock of the start, and is not kept.
  const TimeScale scale = declare_time(raw, options,
                                       is_tick                       ? "TIMETICK"
                                       : seconds && time == *seconds ? "TIME"
                                                                     : table.headings[time].text,
                                       tick.value_or(9), Evidence::format, place);
  std::size_t needed =
      std::max({time, blink.value_or(0), media.value_or(0), fixation.value_or(0), fixation_valid.value_or(0)}) + 1;
  for (const Point& point : points) {
    needed = std::max({needed, point.x + 1, point.y + 1, point.valid.value_or(0) + 1, point.pupil.value_or(0) + 1});
  }
  LabelRuns runs;
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
      raw.events.push_back({GazeEventType::message, Eye::cyclopean, t_ns, t_ns, "medium " + medium, rows.line()});
    }
    last = t_ns;
    const bool blinks = blink && rows.number(*blink) > 0;
    for (const Point& point : points) {
      RawSample sample = position_row(t_ns, rows.line(), point.eye, {rows.number(point.x), rows.number(point.y)},
                                      rows.number(point.pupil));
      const bool good = !point.valid || rows.number(*point.valid) == 1;
      sample.validity = blinks ? GazeValidity::blink : good ? sample.validity : GazeValidity::lost;
      raw.rows.push_back(sample);
    }
    if (fixation && fixation_valid && rows.number(*fixation_valid) == 1) {
      runs.add(GazeEventType::fixation, Eye::cyclopean, std::string(rows.cell(*fixation)), t_ns, rows.line());
    } else {
      runs.end();
    }
  }
  runs.finish(raw);
  declare_places(raw,
                 {PositionUnit::fraction, PositionOrigin::top_left, Evidence::format,
                  table.headings[points.front().x].text + ", " + table.headings[points.front().y].text},
                 place);
  return raw;
}

}  // namespace gazetrace
