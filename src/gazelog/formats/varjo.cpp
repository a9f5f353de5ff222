// SPDX-License-Identifier: Apache-2.0
// Varjo Base CSV: raw_timestamp in nanoseconds, gaze_forward_x and so on in the view's frame with +z forward
// (left-handed), left_ and right_ of each eye, origins in metres. A status of 2 means valid gaze; for a single eye 2
// means compensated and 3 tracked. Windows writes missing values as -nan(ind). Varjo's own logger for Unity has other
// names for the same, and vectors in one cell, which have been divided.
#include "gazelog/mapped_table.hpp"

namespace gazetrace {

double sniff_gaze_varjo(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  if (has("CombinedGazeForward_x") && has("CaptureTime")) {
    return 0.97;
  }
  if (!has("gaze_forward_x") || !has("status")) {
    return 0.0;
  }
  return has("raw_timestamp") || has("relative_to_video_first_frame_timestamp") ? 0.98 : 0.6;
}

RawGaze read_gaze_varjo(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const auto if_there = [&](const std::string& name) { return table.find(name) ? name : std::string(); };
  const bool is_unity = !if_there("CombinedGazeForward_x").empty();
  GazeColumns c;
  c.time = if_there(is_unity ? "CaptureTime" : "raw_timestamp");
  if (c.time.empty()) {
    c.time = if_there("relative_to_video_first_frame_timestamp");
  }
  if (c.time.empty() && options.columns.time.empty()) {
    throw Error(ErrorKind::input, table.place, "there is no column raw_timestamp",
                "older exports have other times: name one with `time-column` and `time-unit`");
  }
  c.time_unit = TimeUnit::ns;
  std::tie(c.x, c.y, c.z) = xyz(is_unity ? "CombinedGazeForward_" : "gaze_forward_");
  c.validity = is_unity ? if_there("GazeStatus") : "status";
  c.valid_values = {"2", "3"};
  if (is_unity) {
    c.valid_values = {"valid", "compensated", "tracked"};
  }
  for (auto* const eye : {&c.left, &c.right}) {
    const std::string side = is_unity ? eye == &c.left ? "LeftEye" : "RightEye" : eye == &c.left ? "left_" : "right_";
    const std::string forward = side + (is_unity ? "Forward_" : "forward_");
    const std::string origin = side + (is_unity ? "Position_" : "origin_");
    if (!table.find(forward + "x")) {
      continue;
    }
    std::tie(eye->x, eye->y, eye->z) = xyz(forward);
    eye->validity = if_there(side + (is_unity ? "Status" : "status"));
    eye->pupil =
        if_there(is_unity ? side.substr(0, side.size() - 3) + "PupilDiameterInMM" : side + "pupil_diameter_in_mm");
    if (table.find(origin + "x")) {
      std::tie(eye->origin_x, eye->origin_y, eye->origin_z) = xyz(origin);
    }
  }
  c.origin_mm_per_unit = 1000;
  if (is_unity && table.find("HMDPosition_x") && table.find("HMDRotation_w")) {
    take_unity_head(c, "HMDPosition_", "HMDRotation_");
    c.head_rotation_w = "HMDRotation_w";
  }
  c.axes = GazeAxes::unity;
  return read_preset(file, table, options, c);
}

}  // namespace gazetrace
