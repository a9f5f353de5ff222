// SPDX-License-Identifier: Apache-2.0
// What the past was off by, from frame to frame: whether it is noise or a bias that lasts.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/luminance.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/motion.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/history_lookup.hpp"
#include "temporal/worth.hpp"

namespace gazetrace {

// Whether the frame tells at this pixel by what its past is off: resampling has changed the past, and the frame has
// samples enough in the pixel itself.
inline bool shows_residual(const Frame& frame, const ImageGray& footprint_px, const PastSums& past, std::size_t pixel) {
  return past.resampled && footprint_px.pixels[pixel] < kFullRatePx && frame.sample_count.pixels[pixel] >= kKnowsNoise;
}

// HistorySurfaces::residual of a past that was found: 0 also where no more than rounding is between the two.
inline float residual_of(const Frame& frame, const PastSums& past, std::size_t pixel) {
  const double seen = luminance(to_double(frame.radiance.pixels[pixel]));
  const double difference = luminance(past.radiance / past.count) - seen;
  return std::abs(difference) > kRounding * seen ? static_cast<float>(difference) : 0.0F;
}

// How far the past was off in two consecutive frames, at full rate. Noise differs from one to the other; the blur of
// texture that was resampled does not.
struct Residuals {
  const ImageGray& now;
  const ImageGray& before;  // luminance of the past minus that of the frame; 0: not known
  const ImageGray& noise;   // variance of the frame as its samples state it; well-spread samples have less in truth

  // A squared bias b^2, beside a variance v of one sample, makes n samples worth n / (1 + n b^2 / v); less where the
  // bias is far above the noise. The pixel itself is left out, since what is kept must not depend on whether it came
  // out bright. `count` and `past_count` are the samples of the frame and of the past at the pixel. All is kept of a
  // past beside a frame of one sample or less, which does not know its own noise.
  [[nodiscard]] double share_kept(const SurfaceMotion& motion, double count, double past_count, int x, int y) const;
};

}  // namespace gazetrace
