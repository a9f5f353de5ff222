// SPDX-License-Identifier: Apache-2.0
// FLIP's one-dimensional kernels for a viewing distance. Each holds 2 radius + 1 weights.
#pragma once

#include <vector>

namespace gazetrace {

struct FlipKernels {
  // Contrast sensitivity of the achromatic, red-green and blue-yellow channels (section 4.1.1 of the paper). The last
  // one is a sum of two Gaussians, so it has two kernels; each is applied along x and y, and the results are added.
  int csf_radius_px = 0;
  std::vector<float> achromatic, red_green, blue_yellow_1, blue_yellow_2;
  // Edge and point detectors (section 4.2): a Gaussian and its first and second derivatives.
  int feature_radius_px = 0;
  std::vector<float> gaussian, edge, point;
};

FlipKernels make_flip_kernels(double pixels_per_degree);

}  // namespace gazetrace
