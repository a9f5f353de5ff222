// SPDX-License-Identifier: Apache-2.0
#include "gazelog/timing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.hpp"

namespace gazetrace {
namespace {

// A difference of integers: nanoseconds from 1970 do not fit into a double. A log is shorter than int64 counts.
std::int64_t step_ns(const GazeLog& log, std::size_t sample) {
  return log.samples[sample].t_ns - log.samples[sample - 1].t_ns;
}

}  // namespace

std::vector<std::size_t> section_starts(const GazeLog& log) {
  std::vector<std::size_t> starts{0};
  for (const GazeEvent& event : log.events) {
    if (event.type != GazeEventType::segment) {
      continue;
    }
    const auto first = std::lower_bound(log.samples.begin(), log.samples.end(), event.begin_ns,
                                        [](const GazeSample& sample, std::int64_t t) { return sample.t_ns < t; });
    if (first != log.samples.end()) {
      starts.push_back(static_cast<std::size_t>(first - log.samples.begin()));
    }
  }
  std::sort(starts.begin(), starts.end());
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
  return starts;
}

GazeTiming measure_timing(const GazeLog& log) {
  GazeTiming timing;
  timing.first_ns = log.samples.front().t_ns;
  timing.last_ns = log.samples.back().t_ns;
  timing.nominal_rate_hz = log.nominal_rate_hz;
  std::vector<double> steps;
  steps.reserve(log.samples.size());
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    steps.push_back(static_cast<double>(step_ns(log, i)));
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
    if (!(step > kGapInSteps * median)) {
      between_gaps.add(step);
    }
  }
  const std::vector<std::size_t> starts = section_starts(log);
  auto start = starts.begin();
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    while (start != starts.end() && *start < i) {
      ++start;
    }
    const std::int64_t step = step_ns(log, i);
    if (!(static_cast<double>(step) > kGapInSteps * median)) {
      continue;
    }
    const bool is_pause = start != starts.end() && *start == i;
    ++(is_pause ? timing.pauses : timing.gaps);
    std::int64_t& total_ns = is_pause ? timing.pauses_total_ns : timing.gaps_total_ns;
    total_ns += step;
    timing.longest_gap_ns = is_pause ? timing.longest_gap_ns : std::max(timing.longest_gap_ns, step);
  }
  timing.mean_rate_hz = between_gaps.mean() > 0 ? 1e9 / between_gaps.mean() : 0;
  timing.jitter_ns = between_gaps.deviation();
  return timing;
}

}  // namespace gazetrace
