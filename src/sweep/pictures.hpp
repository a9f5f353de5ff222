// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/color.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// Bilinear between pixel centres, the border's pixels carried on outwards. Linear light.
ImageRgb upscaled(const ImageRgb& image, int width_px, int height_px, int threads);
// Code values of 8 bits, as viewed() makes them, as bytes again.
DisplayImage display_image_of(const ImageRgb& code);

}  // namespace gazetrace
