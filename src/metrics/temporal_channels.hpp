// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP's sustained and transient temporal channels: the weights of the current frame (tap 0) and of those
// before.
#pragma once

#include <vector>

namespace gazetrace {

struct TemporalFilters {
  std::vector<double> sustained, transient;
};

// Taps over 250 ms (section 3.2 of the paper). Error(usage) where that is less than two.
TemporalFilters temporal_filters(double frames_per_second);

}  // namespace gazetrace
