// SPDX-License-Identifier: Apache-2.0
// Tobii Pro SDK samples as CSV: device_time_stamp (the tracker's clock) and system_time_stamp (the computer's) in
// microseconds, gaze points as fractions of the active display area from the top left, in columns ..._x and ..._y or,
// as Python writes them, as a pair in one cell, "(0.5, 0.3)", which has been divided. Lost samples are NaN with
// validity 0.

#include "gazelog/mapped_table.hpp"

namespace gazetrace {

double sniff_gaze_tobii_sdk(const GazeFile& file) {
  const WordsIn has{head_of(file, 4096)};
  if (!has("gaze_point_on_display_area") || file.text.starts_with('{') || file.text.starts_with('[')) {
    return 0.0;
  }
  return has("device_time_stamp") || has("system_time_stamp") ? 0.98 : 0.5;
}

RawGaze read_gaze_tobii_sdk(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const auto if_there = [&](const std::string& name) { return table.find(name) ? name : std::string(); };
  GazeColumns c;
  c.time = if_there(table.find("device_time_stamp") ? "device_time_stamp" : "system_time_stamp");
  c.time_unit = TimeUnit::us;
  c.position_unit = PositionUnit::fraction;
  c.origin = PositionOrigin::top_left;
  for (auto* const eye : {&c.left, &c.right}) {
    const std::string side = eye == &c.left ? "left_" : "right_";
    if (table.find(side + "gaze_point_on_display_area_x")) {
      eye->x = side + "gaze_point_on_display_area_x";
      eye->y = side + "gaze_point_on_display_area_y";
      eye->validity = if_there(side + "gaze_point_validity");
      eye->pupil = if_there(side + "pupil_diameter");
    }
  }
  if (c.time.empty() && options.columns.time.empty()) {
    throw Error(ErrorKind::input, table.place, "there is no column device_time_stamp or system_time_stamp",
                "name it with `time-column`");
  }
  if (c.left.x.empty() && c.right.x.empty()) {
    throw Error(ErrorKind::input, table.place, "there is no column left_ or right_gaze_point_on_display_area",
                "the columns are: " + column_listing(table));
  }
  RawGaze raw = read_preset(file, table, options, c);
  raw.clock = raw.declared.time_column.value;
  raw.pupil_unit = "mm";
  return raw;
}

}  // namespace gazetrace
