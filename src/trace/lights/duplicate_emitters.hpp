// SPDX-License-Identifier: Apache-2.0
// Emissive triangles that a file holds twice in one place.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// In world space, as transformed: a corner plus an edge would be rounded differently for each order of the corners.
struct EmitterPlace {
  std::array<Vec3d, 3> corners;
  std::int32_t material = 0;
  bool double_sided = false;
};

// For every triangle the first one with the same corners, in whatever order of the same turn, and material; itself
// where it is the only one. A ray meets one of them, so light sampling must count one. Empty where there are no
// duplicates.
std::vector<std::uint32_t> first_of_duplicates(const std::vector<EmitterPlace>& places);

}  // namespace gazetrace
