// SPDX-License-Identifier: Apache-2.0
// A frame through the network, and as much of its samples beside it as they know better.
#pragma once

#include <cstdint>

#include "gazetrace/foveation.hpp"
#include "reconstruct/denoiser_input.hpp"

namespace gazetrace {

// How much work a frame is worth. The smaller network takes 2.6 us a pixel by version 2.5.1, the larger one 6.3.
// `once`: the smaller one over the frame. `with_halves`: the larger one, and the smaller one over one half of its
// samples. Beyond the network's picture of that half, both halves have noise that is independent, and all that the
// network left out. In two bands of coarseness, the finer of which ends at kCoarsePx, the share by which the halves
// agree around a pixel is given back to it. With many samples the picture so becomes their mean, but for single pixels
// that without_outliers() dims.
enum class DenoiserWork : std::uint8_t { once, with_halves };
// `with_halves` where a part of the sites has kSamplesOfBlend samples of the frame's own. Where it has fewer, the time
// buys more as samples: in four clips of moving cameras with 1 and 4 samples a pixel and their neighbours' joined,
// `once` is 0.02 to 0.05 JOD below, and the frame takes half of the time.
DenoiserWork denoiser_work(const SamplingMap& map);

inline constexpr float kSamplesOfBlend = 16;
inline constexpr int kCoarsePx = 8;

// Error(runtime) as open_image_denoise().
ImageRgb denoise(const DenoiserInput& input, DenoiserWork work, int threads);

}  // namespace gazetrace
