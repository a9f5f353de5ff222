// SPDX-License-Identifier: Apache-2.0
// Varjo Base CSV: raw_timestamp in nanoseconds, gaze_forward_x and so on in the view's frame with +z forward
// (left-handed), left_ and right_ of each eye, origins in metres. A status of 2 means valid gaze; for a single eye 2
// means compensated and 3 tracked. Windows writes missing values as -nan(ind).
#include "gazelog/mapped_table.hpp"

namespace gazetrace {

namespace {

// Varjo's own logger for Unity, whose vectors in one cell have been divided.
GazeColumns unity_logger(const DelimitedTable& table) {
  GazeColumns c;
  c.time = "CaptureTime";
  c.time_unit = TimeUnit::ns;
  c.x = "CombinedGazeForward_x";
  c.y = "CombinedGazeForward_y";
  c.z = "CombinedGazeForward_z";
  c.validity = table.find("GazeStatus") ? "GazeStatus" : "";
  c.valid_values = {"valid", "compensated", "tracked"};
  for (auto* const eye : {&c.left, &c.right}) {
    const std::string side = eye == &c.left ? "Left" : "Right";
    if (!table.find(side + "EyeForward_x")) {
      continue;
    }
    eye->x = side + "EyeForward_x";
    eye->y = side + "EyeForward_y";
    eye->z = side + "EyeForward_z";
    eye->validity = table.find(side + "EyeStatus") ? side + "EyeStatus" : "";
    eye->pupil = table.find(side + "PupilDiameterInMM") ? side + "PupilDiameterInMM" : "";
    if (table.find(side + "EyePosition_x")) {
      eye->origin_x = side + "EyePosition_x";
      eye->origin_y = side + "EyePosition_y";
      eye->origin_z = side + "EyePosition_z";
    }
  }
  c.origin_mm_per_unit = 1000;
  if (table.find("HMDPosition_x") && table.find("HMDRotation_w")) {
    c.head_x = "HMDPosition_x";
    c.head_y = "HMDPosition_y";
    c.head_z = "HMDPosition_z";
    c.head_rotation_x = "HMDRotation_x";
    c.head_rotation_y = "HMDRotation_y";
    c.head_rotation_z = "HMDRotation_z";
    c.head_rotation_w = "HMDRotation_w";
    c.head_axes = GazeAxes::unity;
  }
  c.axes = GazeAxes::unity;
  return c;
}

}  // namespace

double sniff_gaze_varjo(const GazeFile& file) {
  const std::string_view line = head_of(file).substr(0, file.text.find('\n'));
  const auto has = [&](std::string_view text) { return line.find(text) != std::string_view::npos; };
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
  if (table.find("CombinedGazeForward_x")) {
    return read_preset(file, table, options, unity_logger(table));
  }
  const auto if_there = [&](const std::string& name) { return table.find(name) ? name : std::string(); };
  GazeColumns c;
  c.time = if_there("raw_timestamp");
  if (c.time.empty()) {
    c.time = if_there("relative_to_video_first_frame_timestamp");
  }
  if (c.time.empty() && options.columns.time.empty()) {
    throw Error(ErrorKind::input, place_of(file, table.header_line), "there is no column raw_timestamp",
                "older exports have other times: name one with `time-column` and `time-unit`");
  }
  c.time_unit = TimeUnit::ns;
  c.x = "gaze_forward_x";
  c.y = "gaze_forward_y";
  c.z = "gaze_forward_z";
  c.validity = "status";
  c.valid_values = {"2", "3"};
  for (auto* const eye : {&c.left, &c.right}) {
    const std::string side = eye == &c.left ? "left_" : "right_";
    if (!table.find(side + "forward_x")) {
      continue;
    }
    eye->x = side + "forward_x";
    eye->y = side + "forward_y";
    eye->z = side + "forward_z";
    eye->validity = if_there(side + "status");
    eye->pupil = if_there(side + "pupil_diameter_in_mm");
    if (table.find(side + "origin_x")) {
      eye->origin_x = side + "origin_x";
      eye->origin_y = side + "origin_y";
      eye->origin_z = side + "origin_z";
    }
  }
  c.origin_mm_per_unit = 1000;
  c.axes = GazeAxes::unity;
  return read_preset(file, table, options, c);
}

}  // namespace gazetrace
