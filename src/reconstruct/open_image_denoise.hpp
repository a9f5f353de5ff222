// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise, where it was found when this was built (GAZETRACE_WITH_OIDN).
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

// The library's ray tracing filter for linear radiance of any range, with albedo (0..1) and normals (world space, zero
// where there is none) that carry no noise themselves. All three are of one size. Values that are not finite or
// negative are read as 0. The bits depend on the library's build and device. Error(runtime) carries the library's own
// message.
ImageRgb open_image_denoise(const ImageRgb& radiance, const ImageRgb& albedo, const ImageRgb& normal, int threads);

}  // namespace gazetrace
