// SPDX-License-Identifier: Apache-2.0
#include "trace/rays/camera_rays.hpp"

#include <algorithm>
#include <cstddef>

namespace gazetrace {

Vec2f concentric_disk(const Vec2f& u) {
  const float x = 2.0F * u.x - 1.0F;
  const float y = 2.0F * u.y - 1.0F;
  if (x == 0 && y == 0) {
    return {};
  }
  const bool wide = std::fabs(x) > std::fabs(y);
  const float radius = wide ? x : y;
  const float angle = static_cast<float>(kPi) * (wide ? 0.25F * (y / x) : 0.5F - 0.25F * (x / y));
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

Camera counted_from(const Vec3d& origin_m, Camera camera) {
  camera.pose.position_m = camera.pose.position_m - origin_m;
  for (CameraPose& pose : camera.shutter_poses) {
    pose.position_m = pose.position_m - origin_m;
  }
  return camera;
}

CameraRays::CameraRays(const Camera& camera, int height_px)
    : perspective_(camera.projection.kind == ProjectionKind::perspective),
      middle_px_{static_cast<float>(camera.middle_px.x), static_cast<float>(camera.middle_px.y)},
      lens_radius_(static_cast<float>(camera.lens.radius_m)),
      focus_distance_(static_cast<float>(camera.lens.focus_distance_m)),
      keys_(camera.shutter_poses) {
  // Pixels are square, so the width follows from the frame's shape.
  step_ = pixel_step_m(camera.projection, height_px);
  placement_ = place(camera.pose);
  near_ = static_cast<float>(camera.projection.near_m);
  if (camera.projection.far_m > 0) {
    far_ = static_cast<float>(camera.projection.far_m);
  }
  (perspective_ ? spread_ : width_) = static_cast<float>(step_);
}

CameraRays::Placement CameraRays::place(const CameraPose& pose) const {
  const Vec3d right = rotate(pose.orientation, {1, 0, 0});
  const Vec3d up = rotate(pose.orientation, {0, 1, 0});
  return {to_float(pose.position_m), to_float(rotate(pose.orientation, {0, 0, -1})), to_float(right * step_),
          to_float(up * step_)};
}

CameraRays::Placement CameraRays::placement_at(float time) const {
  if (keys_.size() < 2) {
    return placement_;
  }
  const double at = static_cast<double>(time) * static_cast<double>(keys_.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), keys_.size() - 2);
  const double s = at - static_cast<double>(first);
  const CameraPose& a = keys_[first];
  const CameraPose& b = keys_[first + 1];
  return place({a.position_m * (1.0 - s) + b.position_m * s, slerp(a.orientation, b.orientation, s)});
}

CameraRays::Ray CameraRays::ray(float x, float y, const Vec2f& lens, float time) const {
  const Placement at = placement_at(time);
  Ray result = ray(at, x, y);
  if (!has_lens()) {
    return result;
  }
  // All rays through the same point of the pixel meet on the plane in focus.
  const float cosine = dot(result.direction, at.forward);
  const float radius = lens_radius_ / static_cast<float>(step_);
  const Vec3f shift = at.right_step * (radius * lens.x) + at.up_step * (radius * lens.y);
  const Vec3f way = result.direction * (focus_distance_ / cosine) - shift;
  const float inverse = 1.0F / std::sqrt(dot(way, way));
  result.origin += shift;
  result.direction = way * inverse;
  // The clipping planes are at given depths, which this ray reaches at other distances.
  const float depth_step = dot(result.direction, at.forward);
  result.tnear = near_ / depth_step;
  result.tfar = far_ / depth_step;
  return result;
}

}  // namespace gazetrace
