// SPDX-License-Identifier: Apache-2.0
// Pico Neo 3 Pro Eye, as a table of a Unity logger: `Timeline` in seconds, `Combine Eye Gaze Vector. x` and so on in
// the head's frame, (0, 0, 0) where lost, the head's pose in Unity's axes. It writes one row in each frame, with the
// newest sample of the tracker, so the age of a sample is unknown. `Foveated Gaze Direction` is another direction and
// is not read.
#include "gazelog/mapped_table.hpp"

namespace gazetrace {
namespace {

GazeColumns preset() {
  GazeColumns c;
  c.time = "Timeline";
  c.time_unit = TimeUnit::s;
  c.x = "Combine Eye Gaze Vector. x";
  c.y = "Combine Eye Gaze Vector. y";
  c.z = "Combine Eye Gaze Vector. z";
  c.head_x = "Head Position. x";
  c.head_y = "Head Position. y";
  c.head_z = "Head Position. z";
  c.head_rotation_x = "Head Rotation. x";
  c.head_rotation_y = "Head Rotation. y";
  c.head_rotation_z = "Head Rotation. z";
  c.axes = GazeAxes::unity;
  c.head_axes = GazeAxes::unity;
  return c;
}

}  // namespace

double sniff_gaze_pico(const GazeFile& file) {
  const std::string_view line = head_of(file).substr(0, file.text.find('\n'));
  const auto has = [&](std::string_view text) { return line.find(text) != std::string_view::npos; };
  return has("Combine Eye Gaze Vector") ? has("Head Rotation") && has("Timeline") ? 0.97 : 0.5 : 0.0;
}

RawGaze read_gaze_pico(const GazeFile& file, const GazeReadOptions& options) {
  RawGaze raw = read_preset(file, open_table(file), options, preset());
  raw.sample_age_unknown = true;
  raw.clock = "frames of the display";
  return raw;
}

}  // namespace gazetrace
