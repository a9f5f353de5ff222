// SPDX-License-Identifier: Apache-2.0
// Unit vectors in 32 bits (Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT
// 3(2), 2014): positions on the unfolded octahedron with 16 bits per coordinate; the largest error is 6e-5 rad.
#pragma once

#include <cmath>
#include <cstdint>

#include "gazetrace/math.hpp"

namespace gazetrace {

inline std::uint32_t encode_octahedral(const Vec3f& n) {
  const float scale = 1.0F / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
  float x = n.x * scale;
  float y = n.y * scale;
  if (n.z < 0) {
    const float folded_x = (1.0F - std::fabs(y)) * std::copysign(1.0F, x);
    y = (1.0F - std::fabs(x)) * std::copysign(1.0F, y);
    x = folded_x;
  }
  const auto quantize = [](float c) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(c * 32767.0F))) & 0xffffU;
  };
  return quantize(x) | (quantize(y) << 16U);
}

// The result is not normalised: it lies on the octahedron and has a length of 0.58 to 1.
inline Vec3f decode_octahedral(std::uint32_t code) {
  const float x = static_cast<float>(static_cast<std::int32_t>(code << 16U) >> 16) * (1.0F / 32767.0F);
  const float y = static_cast<float>(static_cast<std::int32_t>(code) >> 16) * (1.0F / 32767.0F);
  const float z = 1.0F - std::fabs(x) - std::fabs(y);
  const float fold = z < 0 ? -z : 0.0F;
  return {x - std::copysign(fold, x), y - std::copysign(fold, y), z};
}

}  // namespace gazetrace
