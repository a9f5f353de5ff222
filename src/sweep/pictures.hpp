// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/color.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// Scales linear light up by bilinear interpolation between pixel centres; pixels of the border are continued outwards.
ImageRgb upscaled(const ImageRgb& image, int width_px, int height_px, int threads);
// Code values of 8 bits as bytes, from the fractions that viewed() makes of them.
DisplayImage display_image_of(const ImageRgb& code);

}  // namespace gazetrace
