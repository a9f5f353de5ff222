// SPDX-License-Identifier: Apache-2.0
// Tobii Pro SDK samples as CSV: device_time_stamp (the tracker's clock) and system_time_stamp (the computer's) in
// microseconds, gaze points as fractions of the active display area from the top left, in columns ..._x and ..._y or,
// as Python writes them, as a pair in one cell, "(0.5, 0.3)". Lost samples are NaN with validity 0.
#include <fmt/format.h>

#include <algorithm>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

struct SdkEye {
  Eye eye = Eye::left;
  std::size_t x = 0;
  std::optional<std::size_t> y;  // empty: x holds the pair
  std::optional<std::size_t> validity, pupil, pupil_validity;
};

Vec2d pair_from(TableRows& rows, std::size_t column) {
  std::string_view text = rows.cell(column);
  if (is_missing(text)) {
    return {kNan, kNan};
  }
  if (text.starts_with('(') || text.starts_with('[')) {
    text.remove_prefix(1);
  }
  if (text.ends_with(')') || text.ends_with(']')) {
    text.remove_suffix(1);
  }
  const std::size_t comma = text.find(',');
  const std::string_view first = trim(text.substr(0, comma));
  const std::string_view second = comma == std::string_view::npos ? "" : trim(text.substr(comma + 1));
  const auto x = number_from(first);
  const auto y = number_from(second);
  if ((!x && !is_missing(first)) || (!y && !is_missing(second)) || comma == std::string_view::npos) {
    rows.fail(fmt::format("'{}' is not a pair of numbers", text.substr(0, 40)), "it should look like (0.5, 0.3)");
  }
  return {x.value_or(kNan), y.value_or(kNan)};
}

std::vector<SdkEye> find_eyes(const DelimitedTable& table, const std::string& place) {
  std::vector<SdkEye> eyes;
  for (const auto& [side, eye] : {std::pair("left", Eye::left), std::pair("right", Eye::right)}) {
    const auto column = [&table, prefix = side](std::string_view name) {
      return table.find(fmt::format("{}_{}", prefix, name));
    };
    const auto pair = column("gaze_point_on_display_area");
    const auto x = column("gaze_point_on_display_area_x");
    const auto y = column("gaze_point_on_display_area_y");
    if ((x && y) || pair) {
      eyes.push_back({eye, x && y ? *x : *pair, x && y ? y : std::nullopt, column("gaze_point_validity"),
                      column("pupil_diameter"), column("pupil_validity")});
    }
  }
  if (eyes.empty()) {
    throw Error(ErrorKind::input, place, "there is no column left_ or right_gaze_point_on_display_area",
                "the columns are: " + column_listing(table));
  }
  return eyes;
}

}  // namespace

double sniff_gaze_tobii_sdk(const GazeFile& file) {
  const std::string_view head = head_of(file, 4096);
  const auto has = [&](std::string_view text) { return head.find(text) != std::string_view::npos; };
  if (!has("gaze_point_on_display_area") || head.starts_with('{') || head.starts_with('[')) {
    return 0.0;
  }
  return has("device_time_stamp") || has("system_time_stamp") ? 0.98 : 0.5;
}

RawGaze read_gaze_tobii_sdk(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const std::string place = place_of(file, table.header_line);
  const auto own = table.find_any({"device_time_stamp", "system_time_stamp"});
  if (!own && options.columns.time.empty()) {
    throw Error(ErrorKind::input, place, "there is no column device_time_stamp or system_time_stamp",
                "name it with `time-column`");
  }
  RawGaze raw;
  raw.source = file.path;
  raw.format = "tobii-sdk";
  raw.pupil_unit = "mm";
  const std::size_t time = time_column(table, options, own.value_or(0), place);
  raw.clock = table.headings[time].text;
  const TimeScale scale = declare_time(raw, options, raw.clock, 3, Evidence::format, place);
  const std::vector<SdkEye> eyes = find_eyes(table, place);
  std::size_t needed = time + 1;
  for (const SdkEye& eye : eyes) {
    needed = std::max(needed, cells_up_to({eye.x, eye.y, eye.validity, eye.pupil, eye.pupil_validity}));
  }
  TableRows rows(file, table, needed);
  while (rows.next()) {
    rows.check_length();
    const std::int64_t t_ns = rows.time_ns(time, scale);
    for (const SdkEye& eye : eyes) {
      const double pupil = rows.number(eye.pupil);
      const bool pupil_good = !eye.pupil_validity || rows.number(*eye.pupil_validity) == 1;
      const Vec2d at = eye.y ? Vec2d{rows.number(eye.x), rows.number(*eye.y)} : pair_from(rows, eye.x);
      RawSample sample = position_row(t_ns, rows.line(), eye.eye, at, pupil_good ? pupil : kNan);
      if (eye.validity && !(rows.number(*eye.validity) == 1)) {
        sample.validity = GazeValidity::lost;
      }
      raw.rows.push_back(sample);
    }
  }
  declare_places(raw,
                 {PositionUnit::fraction, PositionOrigin::top_left, Evidence::format,
                  table.headings[eyes.front().x].text + ", ..."},
                 place);
  return raw;
}

}  // namespace gazetrace
