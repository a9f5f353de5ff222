// SPDX-License-Identifier: Apache-2.0
// The pyramid of metrics/pyramid.hpp along one axis, as weights of the picture's own pixels: what each value of a
// level, and of the interpolation from the level above it, is a sum of. From them follow the variances of noise
// exactly, borders included. The pyramid is separable, so that the variance of white noise in band b at (i, j) is
//   kk(i) kk(j) - 2 ke(i) ke(j) + ee(i) ee(j)
// with the sums over the pixels of the squared weights of the level (kk), of the interpolation (ee), and of their
// products (ke).
#pragma once

#include <cstddef>
#include <vector>

namespace gazetrace {

// Weights of consecutive pixels.
struct PixelWeights {
  int first = 0;
  std::vector<float> weight;
};

struct LevelRows {
  std::vector<PixelWeights> level, interpolated;  // one for each value of the level
};

// Levels 0 .. levels - 1 of an axis of `size` pixels. `odd_rule`: for each level, whether its far border is treated as
// that of an odd size; empty: as the size is (see FovVideoVdpSettings::original_border).
std::vector<LevelRows> pyramid_rows(int size, std::size_t levels, const std::vector<bool>& odd_rule = {});

// The sums above for white noise, or for noise with one value in each block of pixels.
struct NoiseSums {
  std::vector<float> kk, ke, ee;
};
NoiseSums noise_sums(const LevelRows& rows, int block_px = 1);

inline float noise_variance(const NoiseSums& along_x, const NoiseSums& along_y, std::size_t i, std::size_t j) {
  return along_x.kk[i] * along_y.kk[j] - 2 * along_x.ke[i] * along_y.ke[j] + along_x.ee[i] * along_y.ee[j];
}

}  // namespace gazetrace
