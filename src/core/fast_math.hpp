// SPDX-License-Identifier: Apache-2.0
// Elementary functions for inner loops, with few branches: they give the same bits whatever the C library is, with the
// errors that each states. Polynomials are Taylor or minimax series over the stated range.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "gazetrace/math.hpp"

namespace gazetrace {

// (cos, sin) of 2 pi u for u in [0, 1]; absolute error below 2e-7.
inline Vec2f cos_sin_2pi(float u) noexcept {
  const float quarters = 4.0F * u;
  const auto quadrant = static_cast<std::int32_t>(quarters + 0.5F);
  const float a = (quarters - static_cast<float>(quadrant)) * 1.57079632679F;  // [-pi/4, pi/4]
  const float s = a * a;
  const float sine = a * (1.0F + s * (-1.6666667e-1F + s * (8.3333310e-3F + s * -1.9840874e-4F)));
  const float cosine = 1.0F + s * (-0.5F + s * (4.1666667e-2F + s * (-1.3888397e-3F + s * 2.4760495e-5F)));
  const bool swap = (quadrant & 1) != 0;
  const float c = swap ? sine : cosine;
  const float n = swap ? cosine : sine;
  return {((quadrant + 1) & 2) != 0 ? -c : c, (quadrant & 2) != 0 ? -n : n};
}
inline Vec2d cos_sin_2pi(double u) noexcept {
  return {std::cos(2 * kPi * u), std::sin(2 * kPi * u)};
}

// atan2(y, x) in turns, (-0.5, 0.5]; absolute error below 2e-7 turns. (0, 0) gives 0.
inline float atan2_turns(float y, float x) noexcept {
  const float ax = std::fabs(x);
  const float ay = std::fabs(y);
  const float large = ax > ay ? ax : ay;
  const float small = ax > ay ? ay : ax;
  const float t = large > 0 ? small / large : 0.0F;
  const float s = t * t;
  // Minimax fit of atan(t) / t over [0, 1] (Abramowitz and Stegun 4.4.49, eight terms), divided by 2 pi.
  const float p =
      0.9999999999F +
      s * (-0.3333314528F +
           s * (0.1999355085F +
                s * (-0.1420889944F +
                     s * (0.1065626393F +
                          s * (-0.0752896400F + s * (0.0429096138F + s * (-0.0161657367F + s * 0.0028662257F)))))));
  float turns = t * p * 0.159154943092F;
  turns = ay > ax ? 0.25F - turns : turns;
  turns = x < 0 ? 0.5F - turns : turns;
  return y < 0 ? -turns : turns;
}

// log2(x) for normal x > 0; absolute error below 2e-7 + 1e-7 |log2 x|. For the mantissa m in [sqrt(1/2), sqrt 2) it
// uses log m = 2 atanh((m - 1) / (m + 1)), whose series needs five terms there.
inline float log2_fast(float x) noexcept {
  constexpr std::int32_t kHalfRoot = 0x3f3504f3;  // bits of sqrt(1/2)
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - kHalfRoot) >> 23;
  const float m = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float t = (m - 1.0F) / (m + 1.0F);
  const float s = t * t;
  const float atanh = t * (1.0F + s * (3.3333333e-1F + s * (2.0e-1F + s * (1.4285714e-1F + s * 1.1111111e-1F))));
  return static_cast<float>(exponent) + 2.88539008F * atanh;
}

// 2^x, clamped to normal numbers; relative error below 2e-7.
inline float exp2_fast(float x) noexcept {
  const float limited = x < -126.0F ? -126.0F : (x > 127.0F ? 127.0F : x);
  // Adding and subtracting 1.5 * 2^23 rounds to the nearest integer.
  const float whole = (limited + 12582912.0F) - 12582912.0F;
  const float z = (limited - whole) * 6.93147181e-1F;
  const float p =
      1.0F +
      z * (1.0F +
           z * (0.5F + z * (1.6666667e-1F +
                            z * (4.1666667e-2F + z * (8.3333333e-3F + z * (1.3888889e-3F + z * 1.9841270e-4F))))));
  return p * std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) * (1 << 23));
}

// x^y for x >= 0; 0 and subnormal x give 0 whatever y is.
inline float pow_fast(float x, float y) noexcept {
  constexpr float kLeastNormal = 1.17549435e-38F;
  const float power = exp2_fast(y * log2_fast(x > kLeastNormal ? x : 1.0F));
  return x > kLeastNormal ? power : 0.0F;
}

}  // namespace gazetrace
