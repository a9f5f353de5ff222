// SPDX-License-Identifier: Apache-2.0
// Divides a frame with a given density into square blocks of 1, 2, 4, ... pixels a side, each of which is a site.
#pragma once

#include <vector>

#include "foveation/density_field.hpp"

namespace gazetrace {

// A map without counts, and for each site the number of samples that it would expect if the full rate were one sample
// per pixel.
struct WeighedMap {
  SamplingMap map;
  std::vector<double> weights;
};

// There is one region for every block size from 1 to max_block_px, named block_<side>. A square is divided as long as a
// block of half its side would expect `block_samples` samples (or the full rate, where that is less) at the square's
// densest place. A block is therefore the smallest that expects that many at its densest place, and one pixel where the
// density is 1. The sites of a tile follow a Z-curve. The density of a block is DensityField::over its pixels; blocks
// that the frame's edge cuts count only the pixels inside.
WeighedMap blocks_of_density(const DensityField& field, const FoveationSettings& settings, int width_px, int height_px,
                             double full_rate_spp, int threads);

// The sum of the density over the frame's pixels, by DensityField::over squares of 8 x 8 pixels.
double sum_of_density(const DensityField& field, int width_px, int height_px, int threads);

}  // namespace gazetrace
