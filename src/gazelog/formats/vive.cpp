// SPDX-License-Identifier: Apache-2.0
// HTC Vive Pro Eye through SRanipal. The maker defines no file format, and every laboratory writes its own columns from
// the same structures; this is a preset of a column map for a common logger. Gaze vectors are SRanipal's, +x to the
// wearer's left, +y up, +z forward; eye_valid is a mask of bits of which the second is the direction's; the head's pose
// is Unity's, Euler angles in degrees. A frame counter tells rows that repeat the tracker's last sample.
#include "gazelog/mapped_table.hpp"

namespace gazetrace {

double sniff_gaze_vive(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  return has("gaze_direct_L.x") && has("eye_valid_L") ? has("helmet_rot_x") && has("time(100ns)") ? 0.97 : 0.5 : 0.0;
}

RawGaze read_gaze_vive(const GazeFile& file, const GazeReadOptions& options) {
  GazeColumns c;
  c.time = "time(100ns)";
  for (auto* const eye : {&c.left, &c.right}) {
    const std::string side = eye == &c.left ? "L" : "R";
    std::tie(eye->x, eye->y, eye->z) = xyz("gaze_direct_" + side + ".");
    eye->validity = "eye_valid_" + side;
    eye->openness = "openness_" + side;
    eye->pupil = "pupil_diameter_" + side;
    std::tie(eye->origin_x, eye->origin_y, eye->origin_z) = xyz("gaze_origin_" + side + ".");
  }
  c.valid_mask = 2;
  c.frame = "frame";
  take_unity_head(c, "helmet_pos_", "helmet_rot_");
  c.axes = GazeAxes::sranipal;
  RawGaze raw = read_preset(file, open_table(file), options, c);
  raw.declared.x_is_turned.emplace();  // some loggers turn it, which the eyes' origins show
  return raw;
}

}  // namespace gazetrace
