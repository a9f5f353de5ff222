// SPDX-License-Identifier: Apache-2.0
// Reads pictures of densities, of any size, which are stretched over the frame. u and v are fractions of the frame.
#pragma once

#include "gazetrace/foveation.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// Values between texel centres are interpolated bilinearly.
double picture_at(const ImageGray& picture, double u, double v);

struct PictureRange {
  double least, most;
};
// The least and the largest value over the rectangle from (u0, v0) to (u1, v1).
PictureRange picture_within(const ImageGray& picture, double u0, double v0, double u1, double v1);

double largest_value(const ImageGray& picture);  // of a picture that is not empty
// Of MapContext::density, which must be there.
double full_rate_of_picture(const MapContext& context);

}  // namespace gazetrace
