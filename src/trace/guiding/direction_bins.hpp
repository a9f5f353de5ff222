// SPDX-License-Identifier: Apache-2.0
// The sphere of directions in 128 parts of equal solid angle: 8 bands of equal height along y, each in 16 sectors.
// Which part a direction is in follows from comparisons alone, so that finding it takes no trigonometric function.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gazetrace/math.hpp"

namespace gazetrace {

inline constexpr std::size_t kBands = 8, kSectors = 16, kDirectionBins = kBands * kSectors;

struct DirectionBin {
  std::size_t band = 0, sector = 0;
  [[nodiscard]] std::size_t index() const { return band * kSectors + sector; }
};

// `direction` is of unit length. A sector is 22.5 degrees of the angle about y, counted from x towards z.
inline DirectionBin bin_of(const Vec3f& direction) {
  constexpr float kTanOfSector = 0.41421356F;
  const float height = (direction.y + 1.0F) * (0.5F * static_cast<float>(kBands));
  const auto band = static_cast<std::size_t>(std::clamp(height, 0.0F, static_cast<float>(kBands) - 1.0F));
  const float x = std::fabs(direction.x);
  const float z = std::fabs(direction.z);
  const bool steep = z > x;
  const bool second = std::min(x, z) > kTanOfSector * std::max(x, z);
  // Sectors of the quadrant: 0 and 1 next to x, 2 and 3 next to z.
  const auto in_quadrant = static_cast<std::size_t>(steep ? (second ? 2 : 3) : (second ? 1 : 0));
  const bool left = direction.x < 0;
  const bool below = direction.z < 0;
  const std::size_t half = left ? 7 - in_quadrant : in_quadrant;
  return {band, below ? 15 - half : half};
}

// The direction at a place of a bin, of which (0..1, 0..1) covers all, uniform in solid angle.
inline Vec3f direction_in(const DirectionBin& bin, const Vec2f& at) {
  const float height = (static_cast<float>(bin.band) + at.y) * (2.0F / static_cast<float>(kBands)) - 1.0F;
  const float y = std::clamp(height, -1.0F, 1.0F);
  const float angle = (static_cast<float>(bin.sector) + at.x) * static_cast<float>(2 * kPi / kSectors);
  const float radius = std::sqrt(std::max(0.0F, 1.0F - y * y));
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

}  // namespace gazetrace
