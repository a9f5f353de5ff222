// SPDX-License-Identifier: Apache-2.0
// The primaries that a picture's numbers are in, and the way from them to the working space, linear Rec.709.
#pragma once

#include <array>
#include <optional>

#include "gazetrace/math.hpp"

namespace gazetrace {

// CIE x and y.
struct Primaries {
  Vec2d red, green, blue, white;
};
constexpr Primaries kRec709{{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.3127, 0.329}};
// ACES: SMPTE ST 2065-1 (AP0) and S-2014-004 (AP1, of ACEScg).
constexpr Primaries kAp0{{0.7347, 0.2653}, {0, 1}, {0.0001, -0.077}, {0.32168, 0.33767}};
constexpr Primaries kAp1{{0.713, 0.293}, {0.165, 0.83}, {0.128, 0.044}, {0.32168, 0.33767}};

// The rows of a matrix that takes RGB.
using RgbMatrix = std::array<Vec3d, 3>;
// From RGB in these primaries to linear Rec.709, with Bradford adaptation where the whites differ. Nothing where they
// are Rec.709's own. Where they are the axes of CIE XYZ, the values are tristimulus values, which nothing is adapted
// of. Also nothing where they span no space; is_space() tells.
std::optional<RgbMatrix> matrix_to_rec709(const Primaries& primaries);
bool is_space(const Primaries& primaries);
// The way back.
std::optional<RgbMatrix> matrix_from_rec709(const Primaries& primaries);

inline Vec3f transformed(const RgbMatrix& matrix, const Vec3f& rgb) {
  const Vec3d v = to_double(rgb);
  return to_float({dot(matrix[0], v), dot(matrix[1], v), dot(matrix[2], v)});
}

}  // namespace gazetrace
