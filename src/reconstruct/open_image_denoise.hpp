// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise, which is opened at run time (denoiser_library() in gazetrace/reconstruct.hpp finds it).
#pragma once

#include <cstdint>

#include "gazetrace/image.hpp"
#include "reconstruct/denoiser_input.hpp"

namespace gazetrace {

// The library's networks: 1.4, 2.6, 2.6 and 6.3 us a pixel on one thread, by 2.5.1 on an AMD EPYC. `usual` is its
// quality high where features are not called clean, for which it has no large network. Versions before 2.3 know no fast
// one, and take balanced.
enum class DenoiserNetwork : std::uint8_t { fast, balanced, usual, high };

// The library's ray tracing filter for linear radiance, with its own weights, on `threads` threads (0: all), which
// change no bit. Radiance that is no number is 0 to it, and so much brighter than the picture
// that the network would spread it (kMostOverMean) is as bright as that. Error(runtime) carries the library's own
// message, or says that there is none.
ImageRgb open_image_denoise(const DenoiserInput& input, int threads, DenoiserNetwork network);

// No pixel is shown to the network brighter than kMostOverMean times the geometric mean of all that are lit; and one
// that is kAloneOverBeside times as bright as each of the eight around it, no brighter than kMostAloneOverMean times
// that. A single pixel of 1e3 times the mean leaves no trace, 1e5 times lights a picture of 96 x 96 pixels by a tenth,
// 1e10 times all of any.
inline constexpr float kMostOverMean = 1e5F;
inline constexpr float kMostAloneOverMean = 1e3F;
inline constexpr float kAloneOverBeside = 100;
ImageRgb without_outliers(const ImageRgb& radiance);

}  // namespace gazetrace
