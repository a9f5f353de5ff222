// SPDX-License-Identifier: Apache-2.0
// A rectangle of a frame as a frame of its own: the same pixels, seen by the same eye.
#pragma once

#include "gazetrace/plan.hpp"

namespace gazetrace {

// In pixels of a frame, from its top left corner.
struct PixelRect {
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;

  [[nodiscard]] int right_px() const { return x_px + width_px; }
  [[nodiscard]] int bottom_px() const { return y_px + height_px; }
  [[nodiscard]] bool overlaps(const PixelRect& other) const {
    return x_px < other.right_px() && other.x_px < right_px() && y_px < other.bottom_px() && other.y_px < bottom_px();
  }
};

// The request of what lies in `rect`, which must lie in the frame. Its camera and view show what those of the whole
// frame show there; samples are numbered within the rectangle and are others.
FrameRequest part_of(const FrameRequest& frame, const PixelRect& rect);

}  // namespace gazetrace
