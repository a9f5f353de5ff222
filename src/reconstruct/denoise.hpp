// SPDX-License-Identifier: Apache-2.0
// A frame through the network, and as much of its samples beside it as they know better.
#pragma once

#include <cstdint>

#include "gazetrace/foveation.hpp"
#include "reconstruct/denoiser_input.hpp"

namespace gazetrace {

// How much work of the network a frame is worth. `with_halves`: the high network over the frame, and the balanced one
// over one half of its samples. Beyond the network's picture of that half, both halves have noise that is independent,
// and all that the network left out. In two bands of coarseness, the finer of which ends at kCoarsePx, the share by
// which the halves agree around a pixel is given back to it. With many samples the picture so becomes their mean, but
// for single pixels that without_outliers() dims.
enum class DenoiserWork : std::uint8_t { fast, usual, with_halves };
// By the samples of a frame's own that a part of its sites has: from kSamplesOfBlend on `with_halves`, from
// kSamplesOfUsual on `usual`. With fewer, the time buys more as samples: in four clips of moving cameras, joined over a
// window, each step down takes 0.02 to 0.06 JOD, and time that traces one sample in Lost Empire and a third of one in
// San Miguel (to `fast`), or five and two (to `usual`).
DenoiserWork denoiser_work(const SamplingMap& map);

inline constexpr float kSamplesOfUsual = 4;
inline constexpr float kSamplesOfBlend = 16;
inline constexpr int kCoarsePx = 8;

// Error(runtime) as open_image_denoise().
ImageRgb denoise(const DenoiserInput& input, DenoiserWork work, int threads);

}  // namespace gazetrace
