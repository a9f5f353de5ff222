// SPDX-License-Identifier: Apache-2.0
// Rays of a camera from continuous pixel coordinates, with glTF's near and far planes.
#pragma once

#include <cmath>
#include <limits>

#include "gazetrace/camera.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// Pixel coordinates are taken from the frame's centre, so that 16K frames keep their sub-pixel digits in float.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int height_px);

  struct Ray {
    Vec3f origin, direction;  // direction has length 1
    float tnear, tfar;
    float cone_spread;  // angle of one pixel, rad (perspective)
  };
  // x right, y down, in pixels from the frame's centre.
  [[nodiscard]] Ray ray(float x, float y) const {
    if (perspective_) {
      const Vec3f d = forward_ + right_step_ * x - up_step_ * y;
      const float inverse = 1.0F / std::sqrt(dot(d, d));  // cosine to the view axis
      return {origin_, d * inverse, near_ / inverse, far_ / inverse, spread_ * inverse};
    }
    return {origin_ + right_step_ * x - up_step_ * y, forward_, near_, far_, 0.0F};
  }
  [[nodiscard]] float cone_width() const { return width_; }  // at the origin, m
  [[nodiscard]] const Vec3f& forward() const { return forward_; }
  [[nodiscard]] const Vec3f& origin() const { return origin_; }

 private:
  bool perspective_ = true;
  Vec3f origin_, forward_, right_step_, up_step_;
  float near_ = 0, far_ = std::numeric_limits<float>::infinity();
  float spread_ = 0, width_ = 0;
};

}  // namespace gazetrace
