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
  bool known = false;  // a single tap of a single sample tells nothing of its spread
};

// Of the current frame about a pixel, on the same object, a site's width apart, so that each tap is another site.
Spread spread_around(const Frame& frame, const SurfaceMotion& motion, int x, int y, float footprint_px);

// Brings the past to within the limits; a past that was r times as far off keeps 1 / r^4 of its count: it is
// contradicted, and the limit is no place to rest.
void clip(const Spread& spread, double sigmas, PastSums& past);

}  // namespace gazetrace
