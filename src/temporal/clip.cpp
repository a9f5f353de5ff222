// SPDX-License-Identifier: Apache-2.0
#include "temporal/clip.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/luminance.hpp"

namespace gazetrace {
namespace {

constexpr int kReach = 2;  // the neighborhood is 5x5 sites
// Light below what a float can hold: in the dark the past fades towards it, and its square would leave the range of
// doubles.
constexpr double kNoLight = std::numeric_limits<float>::min();

}  // namespace

Spread spread_around(const Frame& frame, const SurfaceMotion& motion, int x, int y, float footprint_px) {
  const int stride = std::max(1, static_cast<int>(std::lround(footprint_px)));
  const std::uint32_t object = motion.object(x, y);
  Spread spread;
  Vec3d squares;
  double sample_variance = 0;
  double luminance_sum = 0;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const int i = x + dx * stride;
      const int j = y + dy * stride;
      if (i < 0 || j < 0 || i >= frame.radiance.width_px || j >= frame.radiance.height_px ||
          motion.object(i, j) != object) {
        continue;
      }
      const Vec3d value = to_double(frame.radiance(i, j));
      spread.mean += value;
      squares += value * value;
      sample_variance += static_cast<double>(frame.variance(i, j));
      luminance_sum += luminance(value);
      ++spread.taps;
    }
  }
  const double n = spread.taps;
  spread.mean = spread.mean / n;
  const double mean_luminance = luminance_sum / n;
  // The noise that the samples themselves state, for a neighborhood whose pixels agree by chance; the channels share it
  // in proportion.
  const double own = mean_luminance > 0 ? sample_variance / n / (mean_luminance * mean_luminance) : 0;
  spread.known = spread.taps > 1 || own > 0;
  const Vec3d& m = spread.mean;
  spread.variance = {std::max(squares.x / n - m.x * m.x, own * m.x * m.x),
                     std::max(squares.y / n - m.y * m.y, own * m.y * m.y),
                     std::max(squares.z / n - m.z * m.z, own * m.z * m.z)};
  return spread;
}

void clip(const Spread& spread, double sigmas, PastSums& past) {
  if (!spread.known) {
    return;
  }
  const Vec3d mean = past.radiance / past.count;
  // The past has noise of its own: the variance of its luminance, which the channels share in proportion.
  const double past_luminance = luminance(mean);
  const double own =
      past_luminance > kNoLight ? past.variance / (past.count * past.count) / (past_luminance * past_luminance) : 0;
  double farthest = 1;
  const auto clipped = [&](double value, double center, double variance) {
    const double limit =
        sigmas * std::sqrt(std::max(variance, 0.0) + own * value * value) + kRounding * std::abs(center);
    const double off = std::abs(value - center);
    if (off <= limit) {
      return value;
    }
    farthest = std::max(farthest, limit > 0 ? off / limit : 1e3);
    return center + (value < center ? -limit : limit);
  };
  const Vec3d within{clipped(mean.x, spread.mean.x, spread.variance.x),
                     clipped(mean.y, spread.mean.y, spread.variance.y),
                     clipped(mean.z, spread.mean.z, spread.variance.z)};
  const double kept = 1 / (farthest * farthest * farthest * farthest);
  past.count *= kept;
  past.variance *= kept * kept;
  past.radiance = within * past.count;
}

}  // namespace gazetrace
