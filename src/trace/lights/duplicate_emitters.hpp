// SPDX-License-Identifier: Apache-2.0
// Finds emissive triangles that a file contains more than once in the same place.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// Corners in world space, as they were transformed; a corner plus an edge would be rounded differently for each order
// of the corners.
struct EmitterPlace {
  std::array<Vec3d, 3> corners;
  std::int32_t material = 0;
  bool double_sided = false;
};

// For every triangle, the index of the first one with the same material and the same corners in any order of the same
// winding; its own index where it is the only one. A ray hits only one of them, so light sampling must count only one.
// Empty where there are no duplicates.
std::vector<std::uint32_t> first_of_duplicates(const std::vector<EmitterPlace>& places);

}  // namespace gazetrace
