// SPDX-License-Identifier: Apache-2.0
#include "temporal/history_lookup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/luminance.hpp"

namespace gazetrace {
namespace {

// A tap is accepted where it lies this close to the plane of the surface, relative to its distance from the camera, ...
constexpr double kPlaneTolerance = 0.01;
// ... and where its normal is within about 25 degrees.
constexpr float kNormalTolerance = 0.9F;
// Offsets below this are rounding of the projection. They count as none, so that what stands still is not blurred.
constexpr double kSnap_px = 1e-3;
// Sixteen taps are used together only where each was sampled as a pixel of its own and is worth at least this share of
// the best one.
constexpr float kSharpFootprint_px = 1.5F;
constexpr double kSharpCounts = 0.5;

double snapped(double x) {
  const double whole = std::round(x);
  return std::abs(x - whole) < kSnap_px ? whole : x;
}

// A surface point of the current frame, as it was in the earlier view; taps of other surfaces are rejected.
struct Surface {
  const HistorySurfaces& was;
  const PixelProjection& view;
  Vec2d at;
  double depth_m = 0;
  Vec3f normal;
  std::uint32_t object = 0;

  [[nodiscard]] bool is_at(int i, int j) const {
    const std::size_t from = was.object.index(i, j);
    if (was.object.pixels[from] != object) {
      return false;
    }
    if (object == 0) {
      return true;
    }
    const double expected = view.depth_on_plane(at, depth_m, to_double(normal), {i + 0.5, j + 0.5});
    const auto stored = static_cast<double>(was.depth_m.pixels[from]);
    return std::abs(stored - expected) <= kPlaneTolerance * stored &&
           dot(was.normal.pixels[from], normal) >= kNormalTolerance;
  }
};

// Catmull-Rom: interpolates, and is exact for parabolas.
std::array<double, 4> cubic_weights(double t) {
  return {0.5 * t * (-1 + t * (2 - t)), 1 + 0.5 * t * t * (-5 + 3 * t), 0.5 * t * (1 + t * (4 - 3 * t)),
          0.5 * t * t * (t - 1)};
}

struct Sharp {
  Vec3d mean;
  double residual = 0;
};

// A mean between pixels that is sharper than the bilinear one, which takes some texture away with every frame. It is
// clamped to the range of the four pixels around the place. Empty where a tap is rejected, comes from a coarser site,
// or is worth far less than the others.
std::optional<Sharp> sharp_mean(const TemporalHistory& history, const Surface& surface, int x0, int y0, double fx,
                                double fy) {
  const std::array<double, 4> wx = cubic_weights(fx);
  const std::array<double, 4> wy = cubic_weights(fy);
  Vec3d mean;
  double residual = 0;
  Vec3d least{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  Vec3d most{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  double least_count = HUGE_VAL;
  double most_count = 0;
  for (int b = 0; b < 4; ++b) {
    for (int a = 0; a < 4; ++a) {
      const auto weight = wx[static_cast<std::size_t>(a)] * wy[static_cast<std::size_t>(b)];
      if (weight == 0) {
        continue;
      }
      const int i = x0 + a - 1;
      const int j = y0 + b - 1;
      if (i < 0 || j < 0 || i >= history.count_sum.width_px || j >= history.count_sum.height_px) {
        return std::nullopt;
      }
      const std::size_t from = history.count_sum.index(i, j);
      const double count = history.count_sum.pixels[from];
      least_count = std::min(least_count, count);
      most_count = std::max(most_count, count);
      if (!(least_count > kSharpCounts * most_count) || surface.was.footprint_px.pixels[from] > kSharpFootprint_px ||
          !surface.is_at(i, j)) {
        return std::nullopt;
      }
      const Vec3d value = history.radiance_sum.pixels[from] / count;
      mean += weight * value;
      residual += weight * static_cast<double>(surface.was.residual.pixels[from]);
      if ((a == 1 || a == 2) && (b == 1 || b == 2)) {
        least = {std::min(least.x, value.x), std::min(least.y, value.y), std::min(least.z, value.z)};
        most = {std::max(most.x, value.x), std::max(most.y, value.y), std::max(most.z, value.z)};
      }
    }
  }
  return Sharp{
      {std::clamp(mean.x, least.x, most.x), std::clamp(mean.y, least.y, most.y), std::clamp(mean.z, least.z, most.z)},
      residual};
}

}  // namespace

PastSums look_up(const TemporalHistory& history, const PixelProjection& earlier_view, const SurfaceMotion& motion,
                 std::size_t pixel) {
  PastSums past;
  const Vec2d at = motion.other_px.pixels[pixel];
  const int width = history.count_sum.width_px;
  const int height = history.count_sum.height_px;
  // Written so that NaN is rejected.
  if (!(at.x > -0.5 && at.y > -0.5 && at.x < width + 0.5 && at.y < height + 0.5)) {
    return past;
  }
  const HistorySurfaces& was = history.surfaces;
  const Surface surface{was,
                        earlier_view,
                        at,
                        static_cast<double>(motion.other_depth_m.pixels[pixel]),
                        motion.other_normal.pixels[pixel],
                        motion.object.pixels[pixel]};
  const double x = snapped(at.x - 0.5);
  const double y = snapped(at.y - 0.5);
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const double fx = x - x0;
  const double fy = y - y0;
  double deviation = 0;
  for (int tap = 0; tap < 4; ++tap) {
    const int i = x0 + (tap & 1);
    const int j = y0 + (tap >> 1);
    const double weight = ((tap & 1) != 0 ? fx : 1 - fx) * ((tap >> 1) != 0 ? fy : 1 - fy);
    if (!(weight > 0) || i < 0 || j < 0 || i >= width || j >= height || !surface.is_at(i, j)) {
      continue;
    }
    const std::size_t from = history.count_sum.index(i, j);
    const double count = history.count_sum.pixels[from];
    past.radiance += weight * history.radiance_sum.pixels[from];
    past.count += weight * count;
    past.footprint_px += weight * count * static_cast<double>(was.footprint_px.pixels[from]);
    past.residual += weight * count * static_cast<double>(was.residual.pixels[from]);
    // Neighboring pixels may share one and the same sample, so that deviations are added and not variances.
    deviation += weight * std::sqrt(std::max(history.variance_weight_sum.pixels[from], 0.0));
  }
  past.variance = deviation * deviation;
  if (!(past.count > 0)) {
    return past;
  }
  past.footprint_px = past.footprint_px / past.count;
  past.residual = past.residual / past.count;
  past.resampled = fx > 0 || fy > 0;
  if (past.resampled) {
    if (const auto between = sharp_mean(history, surface, x0, y0, fx, fy)) {
      past.between_ways = luminance(between->mean - past.radiance / past.count);
      past.radiance = between->mean * past.count;
      past.residual = between->residual;
    }
  }
  return past;
}

}  // namespace gazetrace
