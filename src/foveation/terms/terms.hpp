// SPDX-License-Identifier: Apache-2.0
// What multiplies the density of any model.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

// Part of the density that is left when the image moves over the retina at this speed, in (0, 1].
double retinal_velocity_factor(double speed_deg_s);

// A picture of multipliers, stretched over the frame: u and v are fractions of it, values between texel centres are
// bilinear.
double contrast_at(const ImageGray& contrast, double u, double v);
struct ContrastRange {
  double least, most;
};
// Over the rectangle from (u0, v0) to (u1, v1).
ContrastRange contrast_within(const ImageGray& contrast, double u0, double v0, double u1, double v1);

}  // namespace gazetrace
