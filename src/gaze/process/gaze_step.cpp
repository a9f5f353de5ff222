// SPDX-License-Identifier: Apache-2.0
#include "gaze/process/gaze_step.hpp"

#include <algorithm>

namespace gazetrace {

std::vector<FilterRun> filter_runs(const GazeLog& log) {
  const std::int64_t most_ns = 3 * median_step_ns(times_of(log));
  const std::vector<GazeSample>& samples = log.samples;
  const auto is_good = [&](const GazeSample& s) { return is_usable(s.validity) && is_finite(place_of(s, log.kind)); };
  std::vector<FilterRun> runs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_good(samples[i])) {
      continue;
    }
    const std::size_t first = i;
    while (i + 1 < samples.size() && is_good(samples[i + 1]) && samples[i + 1].t_ns - samples[i].t_ns <= most_ns) {
      ++i;
    }
    runs.push_back({first, i + 1});
  }
  return runs;
}

Vec3d place_of(const GazeSample& sample, GazeKind kind) {
  return kind == GazeKind::direction ? sample.direction : Vec3d{sample.u, sample.v, 0};
}

void set_place(GazeSample& sample, GazeKind kind, const Vec3d& place) {
  if (kind == GazeKind::direction) {
    sample.direction = normalize(place);
    return;
  }
  sample.u = place.x;
  sample.v = place.y;
  if (sample.validity == GazeValidity::ok || sample.validity == GazeValidity::off_screen) {
    const bool inside = place.x >= 0 && place.x <= 1 && place.y >= 0 && place.y <= 1;
    sample.validity = inside ? GazeValidity::ok : GazeValidity::off_screen;
  }
}

void set_direction(GazeSample& sample, GazeKind kind, const ScreenAngles& screen, const Vec3d& direction) {
  if (kind == GazeKind::direction) {
    sample.direction = direction;
    return;
  }
  const Vec2d at = screen.place(direction);
  if (is_finite(Vec3d{at.x, at.y, 0})) {
    set_place(sample, kind, {at.x, at.y, 0});
  } else {
    sample.validity = GazeValidity::lost;  // the gaze is turned away from the screen altogether
  }
}

}  // namespace gazetrace
