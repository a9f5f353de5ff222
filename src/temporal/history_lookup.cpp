// SPDX-License-Identifier: Apache-2.0
#include "temporal/history_lookup.hpp"

#include <algorithm>
#include <cmath>

namespace gazetrace {
namespace {

// A tap counts where it lies this close to the plane of the surface, relative to its distance from the camera, ...
constexpr double kPlaneTolerance = 0.01;
// ... and where its normal is within about 25 degrees.
constexpr float kNormalTolerance = 0.9F;
// Rounding of the projection, which must not blur what stands still.
constexpr double kSnap_px = 1e-3;

double snapped(double x) {
  const double whole = std::round(x);
  return std::abs(x - whole) < kSnap_px ? whole : x;
}

}  // namespace

PastSums look_up(const TemporalHistory& history, const PixelProjection& earlier_view, const SurfaceMotion& motion,
                 std::size_t pixel) {
  PastSums past;
  const Vec2d at = motion.earlier_px.pixels[pixel];
  const int width = history.count_sum.width_px;
  const int height = history.count_sum.height_px;
  // Written so that NaN fails.
  if (!(at.x > -0.5 && at.y > -0.5 && at.x < width + 0.5 && at.y < height + 0.5)) {
    return past;
  }
  const HistorySurfaces& was = history.surfaces;
  const std::uint32_t object = motion.object.pixels[pixel];
  const Vec3f normal = motion.earlier_normal.pixels[pixel];
  const auto depth = static_cast<double>(motion.earlier_depth_m.pixels[pixel]);
  const double x = snapped(at.x - 0.5);
  const double y = snapped(at.y - 0.5);
  const double x0 = std::floor(x);
  const double y0 = std::floor(y);
  double deviation = 0;
  for (int tap = 0; tap < 4; ++tap) {
    const int i = static_cast<int>(x0) + (tap & 1);
    const int j = static_cast<int>(y0) + (tap >> 1);
    const double weight = ((tap & 1) != 0 ? x - x0 : 1 - (x - x0)) * ((tap >> 1) != 0 ? y - y0 : 1 - (y - y0));
    if (!(weight > 0) || i < 0 || j < 0 || i >= width || j >= height) {
      continue;
    }
    const std::size_t from = history.count_sum.index(i, j);
    if (was.object.pixels[from] != object) {
      continue;
    }
    if (object != 0) {
      const double expected = earlier_view.depth_on_plane(at, depth, to_double(normal), {i + 0.5, j + 0.5});
      const auto stored = static_cast<double>(was.depth_m.pixels[from]);
      if (!(std::abs(stored - expected) <= kPlaneTolerance * stored) ||
          !(dot(was.normal.pixels[from], normal) >= kNormalTolerance)) {
        continue;
      }
    }
    const double count = history.count_sum.pixels[from];
    past.radiance += weight * history.radiance_sum.pixels[from];
    past.count += weight * count;
    past.footprint_px += weight * count * static_cast<double>(was.footprint_px.pixels[from]);
    // Neighbors may stem from one and the same sample, so deviations are added, not variances.
    deviation += weight * std::sqrt(std::max(history.variance_weight_sum.pixels[from], 0.0));
  }
  past.variance = deviation * deviation;
  past.footprint_px = past.count > 0 ? past.footprint_px / past.count : 0;
  return past;
}

}  // namespace gazetrace
