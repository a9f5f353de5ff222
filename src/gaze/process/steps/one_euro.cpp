// SPDX-License-Identifier: Apache-2.0
// The 1 euro filter over directions in degrees, so that beta is a number per degree per second. On a display of about
// 40 pixels per degree its default of 0.3 is 0.007 per pixel per second, as is usual for mice.
#include <fmt/format.h>

#include <algorithm>

#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {
namespace {

double smoothing(double cutoff_hz, double period_s) {
  return 1 / (1 + 1 / (2 * kPi * cutoff_hz * period_s));
}

}  // namespace

std::vector<Vec3d> one_euro_filter(const std::vector<std::int64_t>& t_ns, const std::vector<Vec3d>& x,
                                   const OneEuroSettings& settings) {
  std::vector<Vec3d> filtered;
  filtered.reserve(x.size());
  Vec3d derivative;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i == 0) {
      filtered.push_back(x[0]);
      continue;
    }
    const double period_s = static_cast<double>(t_ns[i] - t_ns[i - 1]) * 1e-9;
    const double a_d = smoothing(settings.d_cutoff_hz, period_s);
    derivative = a_d * ((x[i] - filtered.back()) / period_s) + (1 - a_d) * derivative;
    const double a = smoothing(settings.min_cutoff_hz + settings.beta * length(derivative), period_s);
    filtered.push_back(a * x[i] + (1 - a) * filtered.back());
  }
  return filtered;
}

std::string apply_one_euro(GazeLog& log, const GazeStep& step) {
  const GazeDirections gaze = gaze_directions(log);
  const ScreenAngles screen(log);
  const OneEuroSettings settings{step.value("min-cutoff"), step.value("beta"), step.value("d-cutoff")};
  const bool backward = step.value("backward") != 0;
  std::size_t runs = 0;
  for (const FilterRun& run : filter_runs(log)) {
    ++runs;
    const auto first = static_cast<std::ptrdiff_t>(run.first);
    const auto end = static_cast<std::ptrdiff_t>(run.end);
    std::vector<std::int64_t> t_ns(gaze.t_ns.begin() + first, gaze.t_ns.begin() + end);
    std::vector<Vec3d> x(gaze.direction.begin() + first, gaze.direction.begin() + end);
    for (Vec3d& v : x) {
      v *= kDegPerRad;
    }
    x = one_euro_filter(t_ns, x, settings);
    if (backward) {
      std::reverse(x.begin(), x.end());
      std::reverse(t_ns.begin(), t_ns.end());
      for (std::int64_t& t : t_ns) {
        t = -t;
      }
      x = one_euro_filter(t_ns, x, settings);
      std::reverse(x.begin(), x.end());
    }
    for (std::size_t i = run.first; i < run.end; ++i) {
      set_direction(log.samples[i], log.kind, screen, normalize(x[i - run.first]));
    }
  }
  return fmt::format("{} runs{}", runs, backward ? ", forward and backward" : "");
}

}  // namespace gazetrace
