// SPDX-License-Identifier: Apache-2.0
// The outlines of what moves in the scene: samples of one site there see two things that part from frame to frame.
#pragma once

#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/motion.hpp"

namespace gazetrace {

class MovingEdges {
 public:
  // Neighbours part whose motions in the scene differ by more than this many pixels. Of a body that turns, or bends,
  // neighbours differ by less.
  static constexpr float kPartPx = 0.75F;

  // `to`: the camera in whose view `places` are.
  MovingEdges(const HitPlaces& places, const Camera& to, int width_px, int height_px, int threads);

  // Whether a pixel in the middle of a block and those around the block part.
  [[nodiscard]] bool at(int x_px, int y_px, int block_px) const;

 private:
  struct Motion {
    Vec3f moved_m;
    float distance_m = 0;  // infinite for a miss
  };
  int width_px_, height_px_;
  float pixel_ = 0;  // its size at 1 m, or in m without perspective
  bool perspective_ = true;
  std::vector<Motion> motions_;  // of each pixel; empty: nothing moves
};

}  // namespace gazetrace
