// SPDX-License-Identifier: Apache-2.0
#include "metrics/temporal_channels.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gazetrace/error.hpp"

namespace gazetrace {

TemporalFilters temporal_filters(double frames_per_second) {
  constexpr double kSpan = 0.25;  // s
  constexpr double kPeak = 0.06;  // s
  constexpr double kWidth = 0.5;  // of the logarithm of time
  constexpr double kTransientGain = 0.062170507756932;
  constexpr double kMostRate = 4000;
  if (!(frames_per_second > 0) || frames_per_second > kMostRate) {
    throw Error(ErrorKind::usage, "fovvideovdp", fmt::format("{} frames a second", frames_per_second));
  }
  // The small number absorbs a rounding error of the product: 60 frames per second are 15 taps.
  const int taps = static_cast<int>(std::ceil(kSpan * frames_per_second - 1e-9));
  if (taps < 2) {
    throw Error(ErrorKind::usage, "fovvideovdp",
                fmt::format("{} frames a second leave less than two within 250 ms", frames_per_second));
  }
  const double step_s = taps / frames_per_second / (taps - 1);
  TemporalFilters filters;
  double sum = 0;
  for (int i = 0; i < taps; ++i) {
    const double log_time = std::log(i * step_s + 1e-4) - std::log(kPeak);
    filters.sustained.push_back(std::exp(-log_time * log_time / (2 * kWidth * kWidth)));
    sum += filters.sustained.back();
  }
  for (double& weight : filters.sustained) {
    weight /= sum;
  }
  for (std::size_t i = 0; i + 1 < filters.sustained.size(); ++i) {
    filters.transient.push_back(kTransientGain * (filters.sustained[i + 1] - filters.sustained[i]) / step_s);
  }
  filters.transient.push_back(0);
  return filters;
}

}  // namespace gazetrace
