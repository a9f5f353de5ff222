// SPDX-License-Identifier: Apache-2.0
// Chooses where in or around a pixel a sample falls. The pixel filter is importance-sampled (Ernst et al. 2006), so
// every sample has the weight 1 whatever the filter is.
#pragma once

#include <array>
#include <cstddef>

#include "gazetrace/math.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

class PixelFilterSampler {
 public:
  explicit PixelFilterSampler(PixelFilter filter, double scale = 1);  // the filter is `scale` times as wide
  // Maps [0,1)^2 to an offset from the pixel's centre, in pixels.
  [[nodiscard]] Vec2f offset(float u, float v) const {
    const Vec2f at = box_ ? Vec2f{u - 0.5F, v - 0.5F} : Vec2f{lookup(u), lookup(v)};
    return {at.x * scale_, at.y * scale_};
  }

 private:
  static constexpr std::size_t kSteps = 512;
  [[nodiscard]] float lookup(float u) const {
    const float x = u * static_cast<float>(kSteps);
    const auto i = static_cast<std::size_t>(x);
    const float f = x - static_cast<float>(i);
    return inverse_[i] + f * (inverse_[i + 1] - inverse_[i]);
  }
  bool box_ = true;
  float scale_ = 1;
  std::array<float, kSteps + 2> inverse_{};  // the inverse of the filter's distribution function, at equal steps
};

}  // namespace gazetrace
