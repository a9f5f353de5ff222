// SPDX-License-Identifier: Apache-2.0
// A dense raster. Pixel (i, j) covers [i, i+1) x [j, j+1) and has its centre at (i + 0.5, j + 0.5); the origin is the
// top left corner.
#pragma once

#include <cstddef>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

template <class T>
struct Image {
  int width_px = 0;
  int height_px = 0;
  std::vector<T> pixels;  // row after row, width_px * height_px values

  Image() = default;
  Image(int width, int height, const T& value = T{})
      : width_px(width),
        height_px(height),
        pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x);
  }
  T& operator()(int x, int y) { return pixels[index(x, y)]; }
  const T& operator()(int x, int y) const { return pixels[index(x, y)]; }
  friend bool operator==(const Image&, const Image&) = default;
};

using ImageRgb = Image<Vec3f>;  // linear, scene-referred, Rec.709 primaries, D65 white
using ImageGray = Image<float>;

}  // namespace gazetrace
