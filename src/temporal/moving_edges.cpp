// SPDX-License-Identifier: Apache-2.0
#include "temporal/moving_edges.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/parallel.hpp"
#include "trace/rays/camera_rays.hpp"

namespace gazetrace {

MovingEdges::MovingEdges(const HitPlaces& places, const Camera& to, int width_px, int height_px, int threads)
    : width_px_(width_px), height_px_(height_px) {
  const CameraRays rays(to, height_px);
  const Vec3f step = rays.placement().up_step;
  pixel_ = std::sqrt(dot(step, step));
  perspective_ = rays.is_perspective();
  const auto width = static_cast<std::size_t>(width_px);
  motions_.resize(width * static_cast<std::size_t>(height_px));
  std::atomic<bool> moves = false;
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    bool row_moves = false;
    for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel) {
      const HitPlace place = places.at(pixel);
      const float far = place.object == 0 ? std::numeric_limits<float>::infinity()
                                          : std::sqrt(dot(place.position_m, place.position_m));
      motions_[pixel] = {place.moved_m, far};
      row_moves = row_moves || dot(place.moved_m, place.moved_m) > 0;
    }
    if (row_moves) {
      moves = true;
    }
  });
  if (!moves) {
    motions_.clear();
  }
}

bool MovingEdges::at(int x_px, int y_px, int block_px) const {
  if (motions_.empty()) {
    return false;
  }
  const auto motion = [&](int x, int y) {
    return motions_[static_cast<std::size_t>(std::clamp(y, 0, height_px_ - 1)) * static_cast<std::size_t>(width_px_) +
                    static_cast<std::size_t>(std::clamp(x, 0, width_px_ - 1))];
  };
  const Motion middle = motion(x_px, y_px);
  const int step = std::max(block_px / 2, 1);
  for (int y = y_px - step; y <= y_px + step; y += step) {
    for (int x = x_px - step; x <= x_px + step; x += step) {
      const Motion other = motion(x, y);
      const Vec3f apart = other.moved_m - middle.moved_m;
      const float together_m = kPartPx * pixel_ * (perspective_ ? std::min(middle.distance_m, other.distance_m) : 1.0F);
      if (dot(apart, apart) > together_m * together_m) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace gazetrace
