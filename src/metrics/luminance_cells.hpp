// SPDX-License-Identifier: Apache-2.0
// Means of a picture over square cells, aligned at its origin; cells at the right and lower edges may be smaller.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

ImageGray cell_means(const ImageGray& picture, int cell_px, int threads);
// Gives every pixel the value of its cell.
ImageGray spread_cells(const ImageGray& cells, int cell_px, int width_px, int height_px, int threads);

}  // namespace gazetrace
