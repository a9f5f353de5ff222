// SPDX-License-Identifier: Apache-2.0
// Contrast preservation where samples are sparse: an enhancement, no estimate of radiance.
#pragma once

#include "gazetrace/foveation.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// Blocks of n pixels take contrast from the picture: averaged over a block and interpolated between blocks, a wave of
// f cycles a pixel keeps sinc(f n)^3 of its amplitude, sinc(x) = sin(pi x) / (pi x). Patney et al., "Towards Foveated
// Rendering for Gaze-Tracked Virtual Reality" (ACM TOG 35(6), 2016) found that the eye's periphery misses this contrast
// more than detail, and raise what is left. Here the logarithm of luminance goes `gain` times farther from its mean
// under a Gaussian of standard deviation n pixels:
//   log Y' = log Y + gain (log Y - mean),   gain = strength (sinc(1/4)^-3 - 1) / (1 - exp(-pi^2 / 8))
// so that at strength 1 a wave of half the blocks' own limit, f = 1 / (4 n), is as strong as before. Colours keep their
// ratios. Waves longer than that come out up to 6 % too strong, and noise is raised with the picture.
double contrast_gain(double strength);

// Pixels of 1x1 blocks stay as they are, to the bit; so do black ones. A pixel is at most 7.4 times (e^2) from its
// surroundings as far as the gain goes, so that single bright samples are not raised without bounds. `strength` in
// 0..1; Error(usage) outside of it, and where the map is not of the picture's size.
ImageRgb enhance_contrast(ImageRgb radiance, const SamplingMap& map, double strength, int threads = 0);

}  // namespace gazetrace
