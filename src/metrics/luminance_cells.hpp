// SPDX-License-Identifier: Apache-2.0
// Means of a picture over square cells, grid-aligned at its origin; those at the right and lower edge may be smaller.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

ImageGray cell_means(const ImageGray& picture, int cell_px, int threads);
// Every pixel gets its cell's value.
ImageGray spread_cells(const ImageGray& cells, int cell_px, int width_px, int height_px, int threads);

}  // namespace gazetrace
