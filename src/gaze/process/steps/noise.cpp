// SPDX-License-Identifier: Apache-2.0
// Imprecision: independent normal errors in azimuth and elevation around the gaze. They depend only on the seed and on
// a sample's time, so that a part of a log gets the same errors as the whole.
#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

std::string apply_noise(GazeLog& log, const GazeStep& step) {
  constexpr std::uint64_t kStream = 0x6e6f697365;
  const GazeDirections gaze = gaze_directions(log);
  const ScreenAngles screen(log);
  const double sd = step.value("sd") * kRadPerDeg;
  const CounterRandom random(static_cast<std::uint64_t>(step.value("seed")), kStream);
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    if (is_seen(gaze.direction[i])) {
      const Vec2d error = random.normals(static_cast<std::uint64_t>(gaze.t_ns[i]), 0);
      set_direction(log.samples[i], log.kind, screen,
                    TangentFrame(gaze.direction[i]).direction({sd * error.x, sd * error.y}));
    }
  }
  return "every sample";
}

}  // namespace gazetrace
