// SPDX-License-Identifier: Apache-2.0
// The band of eccentricity and the retinal region of each pixel, its weight by cortical magnification, and sums of maps
// over all three.
#pragma once

#include <array>
#include <cstdint>

#include "gazetrace/compare.hpp"

namespace gazetrace {

struct BandSum {
  double sum = 0;
  double pixels = 0;
};

struct BandSums {
  std::array<BandSum, kEccentricityBandsDeg.size()> bands;
  std::array<BandSum, kRetinalRegionNames.size()> regions;
  double weighted_sum = 0, weight = 0;
  void add(const BandSums& other);
};

struct EccentricityBands {
  Image<std::uint8_t> band, region;
  ImageGray weight;
};

EccentricityBands eccentricity_bands(const PlanarView& view, const Vec2d& gaze_px, const RetinalRegions& regions,
                                     int threads);
BandSums sum_by_band(const EccentricityBands& bands, const ImageGray& map, int margin_px, int threads);

}  // namespace gazetrace
