// SPDX-License-Identifier: Apache-2.0
// Pixels that edges cross become the mean of what all their rays see (guides.hpp: EdgeRay).
#pragma once

#include <cstdint>

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

// `frame`: filled, and needed as it is until all means are known.
void blend_edges(const FilterInput& input, const SurfaceLookup& lookup, const Image<std::uint32_t>& site_of_pixel,
                 Frame& frame);

}  // namespace gazetrace
