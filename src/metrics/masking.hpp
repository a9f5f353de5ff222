// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP's masked difference (section 3.5 of the paper): how much of the difference between two contrasts is
// visible where the contrast that both share masks it. Contrasts are in multiples of their threshold.
#pragma once

#include <cstddef>
#include <vector>

#include "core/fast_math.hpp"

namespace gazetrace {

inline constexpr float kMaskSustained = 2.43685F;  // exponent q of the mask
inline constexpr float kMaskTransient = 4.946F;

inline float masked_difference(float test, float reference, float q) {
  constexpr float kDifferenceExponent = 2.4F;
  constexpr float kMaskGain = 0.106209137F;  // 10^-0.973838
  constexpr float kMost = 10000;
  const float abs_test = test < 0 ? -test : test;
  const float abs_reference = reference < 0 ? -reference : reference;
  const float mask = kMaskGain * (abs_test < abs_reference ? abs_test : abs_reference);
  const float gap = test > reference ? test - reference : reference - test;
  const float difference = pow_fast(gap, kDifferenceExponent) / (1.0F + pow_fast(mask, q));
  return difference < kMost ? difference : kMost;
}

inline void masked_differences(const std::vector<float>& reference, const std::vector<float>& test, float q,
                               std::vector<float>& out) {
  const std::size_t count = out.size();
  for (std::size_t x = 0; x < count; ++x) {
    out[x] = masked_difference(test[x], reference[x], q);
  }
}

}  // namespace gazetrace
