// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP's sustained and transient temporal channels: weights of the current frame (tap 0) and those before it.
#pragma once

#include <vector>

namespace gazetrace {

struct TemporalFilters {
  std::vector<double> sustained, transient;
};

// 250 ms of taps (section 3.2 of the paper). Error(usage) where that is less than two.
TemporalFilters temporal_filters(double frames_per_second);

}  // namespace gazetrace
