// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise, which is opened at run time (denoiser_library() in gazetrace/reconstruct.hpp finds it).
#pragma once

#include "gazetrace/image.hpp"
#include "reconstruct/denoiser_input.hpp"

namespace gazetrace {

// The library's ray tracing filter for linear radiance, with its highest quality and its own weights, on `threads`
// threads (0: all), which change no bit. Radiance that is no number is 0 to it, and so much brighter than the picture
// that the network would spread it (kMostOverMean) is as bright as that. Error(runtime) carries the library's own
// message, or says that there is none.
ImageRgb open_image_denoise(const DenoiserInput& input, int threads);

// No pixel is shown to the network brighter than this times the geometric mean of all that are lit. By 2e4 times a
// single pixel leaves no trace, by 2e6 it dims what is around it, and by 2e10 it lights all of the picture.
inline constexpr float kMostOverMean = 1e5F;
ImageRgb without_outliers(const ImageRgb& radiance);

}  // namespace gazetrace
