// SPDX-License-Identifier: Apache-2.0
// Reports of samples that went wrong: the first ones of a frame, whichever thread found them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

#include "gazetrace/trace.hpp"

namespace gazetrace {

inline constexpr std::size_t kReportedBadSamples = 16;

// Adds a sample to a list in pixel order, which keeps only the first ones.
inline void keep_first(std::vector<BadSample>& list, BadSample sample) {
  const auto before = [](const BadSample& a, const BadSample& b) {
    return std::tie(a.y_px, a.x_px, a.sample, a.what) < std::tie(b.y_px, b.x_px, b.sample, b.what);
  };
  list.insert(std::upper_bound(list.begin(), list.end(), sample, before), std::move(sample));
  if (list.size() > kReportedBadSamples) {
    list.pop_back();
  }
}

}  // namespace gazetrace
