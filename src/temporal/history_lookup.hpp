// SPDX-License-Identifier: Apache-2.0
// What the history knows of a surface point, gathered from the pixels around where it was seen.
#pragma once

#include <cstddef>

#include "gazetrace/motion.hpp"
#include "gazetrace/temporal.hpp"

namespace gazetrace {

struct PastSums {
  Vec3d radiance;       // weighted by counts
  double count = 0;     // 0: nothing is known
  double variance = 0;  // count^2 * variance
  double footprint_px = 0;
  double residual = 0;     // as HistorySurfaces, of the frame before
  bool resampled = false;  // it was looked up between pixels
  // By how much two ways to look it up between pixels differ, in luminance: about as far as each is off where what lies
  // between the pixels is finer than they are. 0 where only one was possible.
  double between_ways = 0;
};

// On a flat surface without noise, relative differences below this come from rounding and from bilinear weights.
inline constexpr double kRounding = 1e-3;

inline void scale_worth(PastSums& past, double factor) {
  past.radiance = past.radiance * factor;
  past.count *= factor;
  past.variance *= factor * factor;
}

// `pixel` is an index into the images of the current frame.
PastSums look_up(const TemporalHistory& history, const PixelProjection& earlier_view, const SurfaceMotion& motion,
                 std::size_t pixel);

}  // namespace gazetrace
