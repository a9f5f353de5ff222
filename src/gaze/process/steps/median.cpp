// SPDX-License-Identifier: Apache-2.0
// The median of an odd window of samples in each of two coordinates: u and v, or azimuth and elevation around the
// window's middle. At the ends of a run the window shrinks by the same amount on both sides.
#include <fmt/format.h>

#include <algorithm>

#include "core/statistics.hpp"
#include "gaze/process/gaze_step.hpp"

namespace gazetrace {

std::string apply_median(GazeLog& log, const GazeStep& step) {
  const auto count = static_cast<std::size_t>(step.value("samples"));
  if (count % 2 == 0) {
    throw Error(ErrorKind::usage, "gaze step median", fmt::format("a window of {} samples has no middle", count),
                "give an odd number");
  }
  const std::vector<GazeSample> before = log.samples;
  std::vector<double> x;
  std::vector<double> y;
  std::size_t changed = 0;
  for (const FilterRun& run : filter_runs(log)) {
    for (std::size_t i = run.first; i < run.end; ++i) {
      const std::size_t half = std::min({count / 2, i - run.first, run.end - 1 - i});
      const TangentFrame frame = log.kind == GazeKind::direction ? TangentFrame(before[i].direction) : TangentFrame();
      x.clear();
      y.clear();
      for (std::size_t k = i - half; k <= i + half; ++k) {
        const Vec2d at =
            log.kind == GazeKind::direction ? frame.angles(before[k].direction) : Vec2d{before[k].u, before[k].v};
        x.push_back(at.x);
        y.push_back(at.y);
      }
      const Vec2d at{upper_median(x), upper_median(y)};
      if (log.kind == GazeKind::direction) {
        // If the window's middle is the median, it keeps exactly its value.
        if (at.x != 0 || at.y != 0) {
          log.samples[i].direction = frame.direction(at);
        }
      } else {
        set_place(log.samples[i], log.kind, {at.x, at.y, 0});
      }
      changed += place_of(log.samples[i], log.kind) == place_of(before[i], log.kind) ? 0 : 1;
    }
  }
  return fmt::format("{} samples changed", changed);
}

}  // namespace gazetrace
