// SPDX-License-Identifier: Apache-2.0
// Makes the rays of a camera from continuous pixel coordinates, with glTF's near and far planes, through a pinhole or a
// lens, at one time or while the shutter is open.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// Maps a point of the unit square to the unit disc; areas keep their proportions and neighbours stay neighbours
// (Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997).
Vec2f concentric_disk(const Vec2f& u);

// The camera in a world whose coordinates count from `origin_m`.
Camera counted_from(const Vec3d& origin_m, Camera camera);

// Pixel coordinates count from the frame's centre, so that sub-pixel digits of 16K frames are kept in float.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int height_px);

  struct Ray {
    Vec3f origin, direction;  // direction has length 1
    float tnear, tfar;
    float cone_spread;  // angle of one pixel, rad (perspective)
  };
  // The camera's position and orientation.
  struct Placement {
    Vec3f origin, forward, right_step, up_step;
  };

  // x right, y down, in pixels from the frame's centre.
  [[nodiscard]] Ray ray(float x, float y) const { return ray(placement_, x, y); }
  // The frame's middle from the view axis, in the same way.
  [[nodiscard]] const Vec2f& middle_px() const { return middle_px_; }
  // `lens` is a point of the unit disc. `time` is 0 when the shutter opens and 1 when it closes.
  [[nodiscard]] Ray ray(float x, float y, const Vec2f& lens, float time) const;

  [[nodiscard]] bool has_lens() const { return lens_radius_ > 0; }
  [[nodiscard]] bool moves() const { return !keys_.empty(); }
  [[nodiscard]] Placement placement_at(float time) const;

  // Where the pinhole in the middle of the frame's time sees what lies that way from it, in pixels from the frame's
  // centre; infinite or no number where it does not lie ahead.
  [[nodiscard]] Vec2f pixel_of(const Vec3f& way) const {
    const float step2 = static_cast<float>(step_ * step_);
    const float depth = perspective_ ? dot(way, placement_.forward) : 1.0F;
    const float scale = 1.0F / (step2 * (depth > 0 ? depth : 0.0F));
    return {dot(way, placement_.right_step) * scale - middle_px_.x,
            -dot(way, placement_.up_step) * scale - middle_px_.y};
  }

  [[nodiscard]] float cone_width() const { return width_; }  // at the origin, m
  [[nodiscard]] const Vec3f& forward() const { return placement_.forward; }
  [[nodiscard]] const Placement& placement() const { return placement_; }  // in the middle of the frame's time
  [[nodiscard]] bool is_perspective() const { return perspective_; }
  [[nodiscard]] const Vec3f& origin() const { return placement_.origin; }

 private:
  [[nodiscard]] Placement place(const CameraPose& pose) const;
  [[nodiscard]] Ray ray(const Placement& at, float x_px, float y_px) const {
    const float x = x_px + middle_px_.x;
    const float y = y_px + middle_px_.y;
    if (perspective_) {
      const Vec3f d = at.forward + at.right_step * x - at.up_step * y;
      const float inverse = 1.0F / std::sqrt(dot(d, d));  // the cosine of the angle to the view axis
      return {at.origin, d * inverse, near_ / inverse, far_ / inverse, spread_ * inverse};
    }
    return {at.origin + at.right_step * x - at.up_step * y, at.forward, near_, far_, 0.0F};
  }

  bool perspective_ = true;
  Placement placement_;
  Vec2f middle_px_;
  double step_ = 0;  // size of a pixel: as a tangent (perspective) or in metres
  float near_ = 0, far_ = std::numeric_limits<float>::infinity();
  float spread_ = 0, width_ = 0;
  float lens_radius_ = 0, focus_distance_ = 1;  // m
  std::vector<CameraPose> keys_;
};

}  // namespace gazetrace
