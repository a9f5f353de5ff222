// SPDX-License-Identifier: Apache-2.0
// Emissive triangles that a file holds twice in one place.
#pragma once

#include <cstdint>
#include <vector>

#include "trace/light_sampling.hpp"

namespace gazetrace {

// For every triangle the first one with the same corners, front and material; itself where it is the only one. A ray
// meets one of them, so light sampling must count one. Empty where there are no duplicates.
std::vector<std::uint32_t> first_of_duplicates(const std::vector<EmissiveTriangle>& triangles);

}  // namespace gazetrace
