// SPDX-License-Identifier: Apache-2.0
// Pico Neo 3 Pro Eye, as a table of a Unity logger: `Timeline` in seconds, `Combine Eye Gaze Vector. x` and so on in
// the head's frame, (0, 0, 0) where lost, the head's pose in Unity's axes. It writes one row in each frame, with the
// newest sample of the tracker, so the age of a sample is unknown. `Foveated Gaze Direction` is another direction and
// is not read.
#include "gazelog/mapped_table.hpp"

namespace gazetrace {

double sniff_gaze_pico(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  return has("Combine Eye Gaze Vector") ? has("Head Rotation") && has("Timeline") ? 0.97 : 0.5 : 0.0;
}

RawGaze read_gaze_pico(const GazeFile& file, const GazeReadOptions& options) {
  GazeColumns c;
  c.time = "Timeline";
  c.time_unit = TimeUnit::s;
  std::tie(c.x, c.y, c.z) = xyz("Combine Eye Gaze Vector. ");
  take_unity_head(c, "Head Position. ", "Head Rotation. ");
  c.axes = GazeAxes::unity;
  RawGaze raw = read_preset(file, open_table(file), options, c);
  raw.sample_age_unknown = true;
  raw.clock = "frames of the display";
  return raw;
}

}  // namespace gazetrace
