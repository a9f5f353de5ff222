// SPDX-License-Identifier: Apache-2.0
// From a density to square blocks of 1, 2, 4, ... pixels a side, each of which is a site.
#pragma once

#include <vector>

#include "foveation/density_field.hpp"

namespace gazetrace {

// A map without counts, and beside each site the number of samples that it expects where the density 1 means one sample
// a pixel.
struct WeighedMap {
  SamplingMap map;
  std::vector<double> weights;
};

// One region for every block size from 1 to max_block_px, named block_<side>. A square is divided while any of its
// places would have `block_samples` (or the full rate, where that is less) in a block of half its side: a block is the
// smallest that expects as many at its densest place, and where the density is 1 it is a pixel. Sites of a tile follow
// a Z-curve. The density of a block is that at the middle of its pixels; blocks that the frame's edge cuts keep their
// own area.
WeighedMap blocks_of_density(const DensityField& field, const FoveationSettings& settings, int width_px, int height_px,
                             double full_rate_spp, int threads);

// Sum of the density over the frame's pixels, by one look at each square of 8 x 8.
double sum_of_density(const DensityField& field, int width_px, int height_px, int threads);

}  // namespace gazetrace
