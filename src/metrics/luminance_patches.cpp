// SPDX-License-Identifier: Apache-2.0
#include "metrics/luminance_patches.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace gazetrace {

ImageGray patch_means(const ImageGray& picture, int patch_px, int threads) {
  ImageGray patches((picture.width_px + patch_px - 1) / patch_px, (picture.height_px + patch_px - 1) / patch_px);
  parallel_for(static_cast<std::size_t>(patches.height_px), threads, [&](std::size_t row) {
    const int top = static_cast<int>(row) * patch_px;
    const int bottom = std::min(top + patch_px, picture.height_px);
    for (int column = 0; column < patches.width_px; ++column) {
      const int left = column * patch_px;
      const int right = std::min(left + patch_px, picture.width_px);
      double sum = 0;
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
          sum += static_cast<double>(picture(x, y));
        }
      }
      patches(column, static_cast<int>(row)) = static_cast<float>(sum / ((bottom - top) * (right - left)));
    }
  });
  return patches;
}

ImageGray spread_patches(const ImageGray& patches, int patch_px, int width_px, int height_px, int threads) {
  ImageGray picture(width_px, height_px);
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width_px; ++x) {
      picture(x, y) = patches(x / patch_px, y / patch_px);
    }
  });
  return picture;
}

}  // namespace gazetrace
