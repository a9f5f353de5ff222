// SPDX-License-Identifier: Apache-2.0
// Reads a texel of any format as floats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/half.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

constexpr std::size_t texel_bytes(TexelFormat format) {
  return format == TexelFormat::unorm8 ? 4 : 8;
}

// For the formats with two bytes per channel. With TexelFormat::half, RGB is linear light.
inline Vec4f deep_texel(const std::uint8_t* texel, TexelFormat format) {
  std::uint16_t code[4];
  std::memcpy(code, texel, sizeof code);
  if (format == TexelFormat::half) {
    return {half_to_float(code[0]), half_to_float(code[1]), half_to_float(code[2]), half_to_float(code[3])};
  }
  constexpr float kScale = 1.0F / 65535.0F;
  return {static_cast<float>(code[0]) * kScale, static_cast<float>(code[1]) * kScale,
          static_cast<float>(code[2]) * kScale, static_cast<float>(code[3]) * kScale};
}

}  // namespace gazetrace
