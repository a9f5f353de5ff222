// SPDX-License-Identifier: Apache-2.0
// A systematic error of the tracker: the gaze is turned by x to the right, then by y up.
#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

std::string apply_offset(GazeLog& log, const GazeStep& step) {
  const GazeDirections gaze = gaze_directions(log);
  const ScreenAngles screen(log);
  const double x = step.value("x") * kRadPerDeg;
  const double y = step.value("y") * kRadPerDeg;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    if (is_seen(gaze.direction[i])) {
      set_direction(log.samples[i], log.kind, screen, TangentFrame(gaze.direction[i]).direction({x, y}));
    }
  }
  return "every sample";
}

}  // namespace gazetrace
