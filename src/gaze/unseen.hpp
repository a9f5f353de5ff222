// SPDX-License-Identifier: Apache-2.0
// Times of a log at which nobody saw what the eye did: in a gap, in a pause and after the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

inline std::int64_t saturating_difference(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) {
    return a > b ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
  }
  return difference;
}

// Whether `row`, the last one that is not after the time, lies farther back than `max_gap_ns`, and so far that a row is
// missing at least, at the rate that the rows before it have. A log of one row stands for a gaze that never moves.
inline bool is_unseen(const std::vector<GazeSample>& samples, std::size_t row, std::int64_t t_ns,
                      std::int64_t max_gap_ns) {
  constexpr std::int64_t kSteps = 3;
  const std::int64_t step_ns = row > 0 ? saturating_difference(samples[row].t_ns, samples[row - 1].t_ns) : 0;
  const std::int64_t age_ns = saturating_difference(t_ns, samples[row].t_ns);
  return samples.size() > 1 && age_ns > max_gap_ns && age_ns / kSteps > step_ns;
}

}  // namespace gazetrace
