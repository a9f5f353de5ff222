// SPDX-License-Identifier: Apache-2.0
// Means of a picture over square patches, aligned at its origin; patches at the right and lower edges may be smaller.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

ImageGray patch_means(const ImageGray& picture, int patch_px, int threads);
// Gives every pixel the value of its patch.
ImageGray spread_patches(const ImageGray& patches, int patch_px, int width_px, int height_px, int threads);

}  // namespace gazetrace
