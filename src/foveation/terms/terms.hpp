// SPDX-License-Identifier: Apache-2.0
// The terms that multiply the density of any model.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

// The share of the density that is left while the image moves over the retina at this speed, in (0, 1].
double retinal_velocity_factor(double speed_deg_s);

// Reads a picture of multipliers that is stretched over the frame: u and v are fractions of the frame, and values
// between texel centres are interpolated bilinearly.
double contrast_at(const ImageGray& contrast, double u, double v);
struct ContrastRange {
  double least, most;
};
// The least and the largest multiplier over the rectangle from (u0, v0) to (u1, v1).
ContrastRange contrast_within(const ImageGray& contrast, double u0, double v0, double u1, double v1);

}  // namespace gazetrace
