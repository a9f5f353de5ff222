// SPDX-License-Identifier: Apache-2.0
#include "visible/displayed_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "metrics/band_sensitivity.hpp"

namespace gazetrace {
namespace {

float usable(float squared_error) {
  return squared_error > 0 && squared_error < std::numeric_limits<float>::max() ? squared_error : 0.0F;
}

}  // namespace

DisplayedError displayed_error(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors,
                               float least_contrast, int threads) {
  // Where there is no error, the slope is that of a small one.
  constexpr float kSmallError = 1e-3F;
  constexpr float kLeastError = 1e-6F;
  const ImageGray& scene = picture.luminance;
  const DisplayCurve& curve = picture.display;
  DisplayedError shown;
  shown.luminance = ImageGray(scene.width_px, scene.height_px);
  shown.slope = shown.luminance;
  shown.variance.assign(errors.size(), shown.luminance);
  parallel_for(static_cast<std::size_t>(scene.height_px), threads, [&](std::size_t row) {
    const std::size_t from = row * static_cast<std::size_t>(scene.width_px);
    for (std::size_t i = from; i < from + static_cast<std::size_t>(scene.width_px); ++i) {
      const float light = std::isfinite(scene.pixels[i]) ? std::max(scene.pixels[i], 0.0F) : 0.0F;
      float squared = 0;
      for (const ErrorComponent& error : errors) {
        squared += usable(error.squared_error.pixels[i]);
      }
      const float deviation = std::max({std::sqrt(squared), kSmallError * light, kLeastError});
      const float slope = (curve(light + deviation) - curve(light - deviation)) / (2 * deviation);
      shown.luminance.pixels[i] = curve(light);
      shown.slope.pixels[i] = slope;
      for (std::size_t k = 0; k < errors.size(); ++k) {
        shown.variance[k].pixels[i] = usable(errors[k].squared_error.pixels[i]) * slope * slope;
      }
      if (least_contrast > 0) {
        const float least = least_contrast * std::max(shown.luminance.pixels[i], kLeastBackground);
        shown.variance.front().pixels[i] += least * least;
      }
    }
  });
  return shown;
}

}  // namespace gazetrace
