// SPDX-License-Identifier: Apache-2.0
// Each pixel that an edge crosses becomes the mean of what its rays see (guides.hpp: EdgeRay).
#pragma once

#include <cstdint>

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

// `picture` is filled; its values are read until all means are known.
void blend_edges(const FilterInput& input, const SurfaceLookup& lookup, const Image<std::uint32_t>& site_of_pixel,
                 SurfacePicture& picture);

}  // namespace gazetrace
