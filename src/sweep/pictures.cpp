// SPDX-License-Identifier: Apache-2.0
#include "sweep/pictures.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

struct Between {
  int low = 0, high = 0;
  float part = 0;
};

// Where the centre of an output pixel lies on the raster of the input.
Between between(int at, int size, int of_size) {
  const double place = (at + 0.5) * of_size / size - 0.5;
  const double low = std::floor(place);
  return {std::clamp(static_cast<int>(low), 0, of_size - 1), std::clamp(static_cast<int>(low) + 1, 0, of_size - 1),
          static_cast<float>(place - low)};
}

}  // namespace

ImageRgb upscaled(const ImageRgb& image, int width_px, int height_px, int threads) {
  ImageRgb result(width_px, height_px);
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const Between v = between(y, height_px, image.height_px);
    for (int x = 0; x < width_px; ++x) {
      const Between h = between(x, width_px, image.width_px);
      const Vec3f above = image(h.low, v.low) * (1 - h.part) + image(h.high, v.low) * h.part;
      const Vec3f below = image(h.low, v.high) * (1 - h.part) + image(h.high, v.high) * h.part;
      result(x, y) = above * (1 - v.part) + below * v.part;
    }
  });
  return result;
}

DisplayImage display_image_of(const ImageRgb& code) {
  constexpr float kMost = 255;
  DisplayImage image{code.width_px, code.height_px, 8, {}};
  image.bytes.reserve(3 * code.pixels.size());
  for (const Vec3f& pixel : code.pixels) {
    for (const float value : {pixel.x, pixel.y, pixel.z}) {
      image.bytes.push_back(static_cast<std::uint8_t>(std::lround(kMost * value)));
    }
  }
  return image;
}

}  // namespace gazetrace
