// SPDX-License-Identifier: Apache-2.0
// A frame through the network, and as much of its samples beside it as they know better.
#pragma once

#include "reconstruct/denoiser_input.hpp"

namespace gazetrace {

// Where a part of the pixels has this many samples, the network runs twice: over the frame, and with less work (2.6 for
// 6.3 us a pixel by version 2.5.1) over one half of its samples. Beyond the network's picture of that half, both halves
// have noise that is independent, and all that the network left out. In two bands of coarseness, the finer of which
// ends at kCoarsePx, the share by which the halves agree around a pixel is given back to it. With many samples the
// picture so becomes their mean, but for single pixels that without_outliers() dims.
inline constexpr float kSamplesOfBlend = 16;
inline constexpr int kCoarsePx = 8;

// Error(runtime) as open_image_denoise().
ImageRgb denoise(const DenoiserInput& input, int threads);

}  // namespace gazetrace
