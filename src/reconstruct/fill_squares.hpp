// SPDX-License-Identifier: Apache-2.0
// Fills every pixel that needs filtering with the light of the four blocks around it (surface_gather.hpp). Where these
// have too few samples on similar surfaces, farther blocks are asked (surface_lookup.hpp).
#pragma once

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

void fill_squares(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings,
                  const SurfaceLookup& lookup, SurfacePicture& picture);

}  // namespace gazetrace
