// SPDX-License-Identifier: Apache-2.0
// A rectangle of a frame as a frame of its own: the same pixels, seen by the same eye.
#pragma once

#include "gazetrace/image.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

// In pixels of a frame, from its top left corner.
struct PixelRect {
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;

  [[nodiscard]] int right_px() const { return x_px + width_px; }
  [[nodiscard]] int bottom_px() const { return y_px + height_px; }
  [[nodiscard]] bool holds(double x, double y) const {
    return x >= x_px && x < right_px() && y >= y_px && y < bottom_px();
  }
  [[nodiscard]] bool overlaps(const PixelRect& other) const {
    return x_px < other.right_px() && other.x_px < right_px() && y_px < other.bottom_px() && other.y_px < bottom_px();
  }
};

// The request of what lies in `rect`, which must lie in the frame. Its camera and view show what those of the whole
// frame show there; samples are numbered within the rectangle and are others.
FrameRequest part_of(const FrameRequest& frame, const PixelRect& rect);
// The same as a window of its frame: its samples are those that the whole frame has there.
FrameRequest window_of(const FrameRequest& frame, const PixelRect& rect);

// What an image shows in `rect`, which must lie in it.
template <class T>
Image<T> cut_out(const Image<T>& image, const PixelRect& rect) {
  Image<T> part(rect.width_px, rect.height_px);
  for (int y = 0; y < rect.height_px; ++y) {
    for (int x = 0; x < rect.width_px; ++x) {
      part(x, y) = image(rect.x_px + x, rect.y_px + y);
    }
  }
  return part;
}

template <class T>
void paste(const Image<T>& part, const PixelRect& rect, Image<T>& image) {
  for (int y = 0; y < rect.height_px; ++y) {
    for (int x = 0; x < rect.width_px; ++x) {
      image(rect.x_px + x, rect.y_px + y) = part(x, y);
    }
  }
}

}  // namespace gazetrace
