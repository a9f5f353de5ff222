// SPDX-License-Identifier: Apache-2.0
// KHR_materials_dispersion: the indices at the C, d and F lines are used for red, green and blue. The Abbe number is
// V = 20 / dispersion = (n_d - 1) / (n_F - n_C), so half the spread is (n_d - 1) dispersion / 40, as the extension
// states it. A path that meets such a body continues with one colour (see kernel/layers.hpp); the estimate stays
// unbiased.
#pragma once

#include <algorithm>

namespace gazetrace {

// channel: 0 red, 1 green, 2 blue.
inline float dispersed_ior(float ior, float dispersion, int channel) {
  return std::max(ior + static_cast<float>(channel - 1) * (ior - 1.0F) * dispersion * 0.025F, 1.0F);
}

}  // namespace gazetrace
