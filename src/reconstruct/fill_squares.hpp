// SPDX-License-Identifier: Apache-2.0
// Fills all pixels that need filtering with the light of the four blocks between which each lies (surface_gather.hpp);
// where those have not enough on like surfaces, with that of farther ones (surface_lookup.hpp).
#pragma once

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

void fill_squares(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings,
                  const SurfaceLookup& lookup, Frame& frame);

}  // namespace gazetrace
