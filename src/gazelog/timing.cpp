// SPDX-License-Identifier: Apache-2.0
#include "gazelog/timing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.hpp"

namespace gazetrace {

GazeTiming measure_timing(const GazeLog& log) {
  GazeTiming timing;
  timing.first_ns = log.samples.front().t_ns;
  timing.last_ns = log.samples.back().t_ns;
  timing.nominal_rate_hz = log.nominal_rate_hz;
  std::vector<double> steps;
  steps.reserve(log.samples.size());
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    steps.push_back(static_cast<double>(log.samples[i].t_ns) - static_cast<double>(log.samples[i - 1].t_ns));
  }
  // Nanoseconds from 1970 do not fit into a double, but differences of the integers do.
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    std::int64_t step = 0;
    if (!__builtin_sub_overflow(log.samples[i].t_ns, log.samples[i - 1].t_ns, &step)) {
      steps[i - 1] = static_cast<double>(step);
    }
  }
  if (steps.empty()) {
    return timing;
  }
  const double median = lower_quantile(steps, 0.5);
  timing.step_q1_ns = lower_quantile(steps, 0.25);
  timing.step_q3_ns = lower_quantile(steps, 0.75);
  timing.median_rate_hz = median > 0 ? 1e9 / median : 0;
  RunningSpread between_gaps;
  for (const double step : steps) {
    if (step > kGapInSteps * median) {
      ++timing.gaps;
      timing.gaps_total_ns += static_cast<std::int64_t>(std::min(step, 9e18));
      timing.longest_gap_ns = std::max(timing.longest_gap_ns, static_cast<std::int64_t>(std::min(step, 9e18)));
      continue;
    }
    between_gaps.add(step);
  }
  timing.mean_rate_hz = between_gaps.mean() > 0 ? 1e9 / between_gaps.mean() : 0;
  timing.jitter_ns = between_gaps.deviation();
  return timing;
}

}  // namespace gazetrace
