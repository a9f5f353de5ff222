// SPDX-License-Identifier: Apache-2.0
#include "temporal/resampling_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/luminance.hpp"
#include "temporal/worth.hpp"

namespace gazetrace {
namespace {

// Two surfaces whose motions differ by less than this many pixels a frame share their pixels as before.
constexpr double kSlidesPx = 0.05;
// The variance of what two ways of interpolation differ by, beside that of what they interpolate, for white noise.
constexpr double kNoiseBetweenWays = 0.1;
// At an edge that slides, a difference counts as an error where its square is above the variance of both by a factor of
// 1 + kFewSamples / count: a frame of few samples knows its variance badly, and what it would lose by mistake is worth
// more.
constexpr double kFewSamples = 8;

struct Around {
  int x0, x1, y0, y1;
};

Around around(int x, int y, int reach, int width, int height) {
  return {std::max(x - reach, 0), std::min(x + reach, width - 1), std::max(y - reach, 0),
          std::min(y + reach, height - 1)};
}

// Whether a neighbour shows another surface, and that one moves differently.
bool slides_now(const SurfaceMotion& motion, int x, int y) {
  const Around at = around(x, y, 1, motion.object.width_px, motion.object.height_px);
  const Vec2d here = motion.other_px(x, y);
  for (int j = at.y0; j <= at.y1; ++j) {
    for (int i = at.x0; i <= at.x1; ++i) {
      if (motion.object(i, j) == motion.object(x, y)) {
        continue;
      }
      const Vec2d there = motion.other_px(i, j);
      // Written so that NaN counts as moving differently.
      if (!(std::hypot(there.x - here.x - (i - x), there.y - here.y - (j - y)) < kSlidesPx)) {
        return true;
      }
    }
  }
  return false;
}

// Whether another surface was beside the place in the other frame that is not beside it now.
bool showed_another(const HistorySurfaces& was, const SurfaceMotion& motion, int x, int y) {
  const Vec2d place = motion.other_px(x, y);
  const int px = static_cast<int>(std::floor(place.x));
  const int py = static_cast<int>(std::floor(place.y));
  const Around then = around(px, py, 1, was.object.width_px, was.object.height_px);
  const Around now = around(x, y, 1, motion.object.width_px, motion.object.height_px);
  for (int j = then.y0; j <= then.y1; ++j) {
    for (int i = then.x0; i <= then.x1; ++i) {
      const std::uint32_t object = was.object(i, j);
      bool is_here = object == motion.object(x, y);
      for (int v = now.y0; v <= now.y1 && !is_here; ++v) {
        for (int u = now.x0; u <= now.x1 && !is_here; ++u) {
          is_here = motion.object(u, v) == object;
        }
      }
      if (!is_here) {
        return true;
      }
    }
  }
  return false;
}

double mean_variance(const Frame& frame, const SurfaceMotion& motion, int x, int y) {
  const Around at = around(x, y, 1, frame.variance.width_px, frame.variance.height_px);
  double sum = 0;
  int taps = 0;
  for (int j = at.y0; j <= at.y1; ++j) {
    for (int i = at.x0; i <= at.x1; ++i) {
      if (motion.object(i, j) == motion.object(x, y)) {
        sum += static_cast<double>(frame.variance(i, j));
        ++taps;
      }
    }
  }
  return sum / taps;
}

}  // namespace

double share_kept_between_pixels(const PastSums& past, const Frame& frame, const HistorySurfaces& was,
                                 const SurfaceMotion& motion, std::size_t pixel, int pasts) {
  const auto count = static_cast<double>(frame.sample_count.pixels[pixel]);
  if (!(count >= kKnowsNoise) || !(past.count > 0)) {
    return 1;
  }
  const int x = static_cast<int>(pixel % static_cast<std::size_t>(frame.radiance.width_px));
  const int y = static_cast<int>(pixel / static_cast<std::size_t>(frame.radiance.width_px));
  const double of_past = past.variance / (past.count * past.count);
  const double noise = mean_variance(frame, motion, x, y);
  double bias = std::max(past.between_ways * past.between_ways - kNoiseBetweenWays * of_past, 0.0);
  if (slides_now(motion, x, y) || showed_another(was, motion, x, y)) {
    const double off = luminance(past.radiance / past.count - to_double(frame.radiance.pixels[pixel]));
    bias =
        std::max(bias, off * off - (1 + kFewSamples / count) *
                                       (std::max(noise, static_cast<double>(frame.variance.pixels[pixel])) + of_past));
  }
  if (!(bias > 0)) {
    return 1;
  }
  return 1 / (1 + pasts * past.count / count * bias / std::max(noise, 1e-12 * bias));
}

}  // namespace gazetrace
