// SPDX-License-Identifier: Apache-2.0
// IEEE 754 binary16 for storage, since the compilers in use have no such type in C++.
#pragma once

#include <bit>
#include <cstdint>

namespace gazetrace {

inline constexpr float kLargestHalf = 65504.0F;

// Exact for every finite code; infinities and NaN give 65536 and more.
constexpr float half_to_float(std::uint16_t half) {
  const std::uint32_t sign = (half & 0x8000U) << 16U;
  // The exponent's bias is corrected by a multiplication, which is right for subnormal numbers, too.
  const float magnitude = std::bit_cast<float>((half & 0x7fffU) << 13U) * 0x1p112F;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(magnitude) | sign);
}

// Rounds to the nearest, ties to even. The value must be finite; it is clamped to [-65504, 65504].
constexpr std::uint16_t float_to_half(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>(bits >> 16U & 0x8000U);
  float magnitude = std::bit_cast<float>(bits & 0x7fffffffU);
  magnitude = magnitude < kLargestHalf ? magnitude : kLargestHalf;
  if (magnitude < 0x1p-14F) {
    // Subnormal: adding 0.5 leaves multiples of 2^-24 in the lowest bits, rounded as floats are.
    return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(magnitude + 0.5F) - 0x3f000000U));
  }
  std::uint32_t code = std::bit_cast<std::uint32_t>(magnitude) - (112U << 23U);
  code += 0xfffU + (code >> 13U & 1U);
  const std::uint32_t half = code >> 13U;
  return static_cast<std::uint16_t>(sign | (half < 0x7c00U ? half : 0x7bffU));
}

}  // namespace gazetrace
