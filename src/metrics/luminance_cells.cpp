// SPDX-License-Identifier: Apache-2.0
#include "metrics/luminance_cells.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace gazetrace {

ImageGray cell_means(const ImageGray& picture, int cell_px, int threads) {
  ImageGray cells((picture.width_px + cell_px - 1) / cell_px, (picture.height_px + cell_px - 1) / cell_px);
  parallel_for(static_cast<std::size_t>(cells.height_px), threads, [&](std::size_t row) {
    const int top = static_cast<int>(row) * cell_px;
    const int bottom = std::min(top + cell_px, picture.height_px);
    for (int column = 0; column < cells.width_px; ++column) {
      const int left = column * cell_px;
      const int right = std::min(left + cell_px, picture.width_px);
      double sum = 0;
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
          sum += static_cast<double>(picture(x, y));
        }
      }
      cells(column, static_cast<int>(row)) = static_cast<float>(sum / ((bottom - top) * (right - left)));
    }
  });
  return cells;
}

ImageGray spread_cells(const ImageGray& cells, int cell_px, int width_px, int height_px, int threads) {
  ImageGray picture(width_px, height_px);
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width_px; ++x) {
      picture(x, y) = cells(x / cell_px, y / cell_px);
    }
  });
  return picture;
}

}  // namespace gazetrace
