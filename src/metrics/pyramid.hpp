// SPDX-License-Identifier: Apache-2.0
// Halves and doubles pictures with the kernel 0.05, 0.25, 0.4, 0.25, 0.05 (Burt and Adelson, "The Laplacian pyramid as
// a compact image code", 1983, with a = 0.4). Sizes go from n to ceil(n / 2) and back.
#pragma once

#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// Beyond the border pixels are mirrored, including the border pixel. `original_border`: see FovVideoVdpSettings.
ImageGray halved(const ImageGray& image, bool original_border, int threads);

// Row y of `image` doubled to a raster of this width; beyond the border its pixels are repeated. `buffer` is scratch
// memory.
void doubled_row(const ImageGray& image, int y, int width_px, std::vector<float>& buffer, float* out);
ImageGray doubled(const ImageGray& image, int width_px, int height_px, int threads);

}  // namespace gazetrace
