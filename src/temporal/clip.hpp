// SPDX-License-Identifier: Apache-2.0
// Variance clipping: the past stays within what the current frame shows about a pixel.
#pragma once

#include "gazetrace/motion.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/history_lookup.hpp"

namespace gazetrace {

// Mean and variance of a channel over the neighborhood.
struct Spread {
  Vec3d mean, variance;
  int taps = 0;
  bool known = false;  // false where there is a single tap of a single sample, which says nothing of its spread
};

// The spread of the current frame around a pixel, over taps on the same object. They are a site's width apart, so that
// each tap reads another site.
Spread spread_around(const Frame& frame, const SurfaceMotion& motion, int x, int y, float footprint_px);

// Clips the past to the limits. A past that was r times as far off keeps 1 / r^4 of its count, since the frame
// contradicts it, and a value that merely sits at the limit deserves little trust.
void clip(const Spread& spread, double sigmas, PastSums& past);

}  // namespace gazetrace
