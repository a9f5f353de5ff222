// SPDX-License-Identifier: Apache-2.0
#include "trace/camera_rays.hpp"

namespace gazetrace {

CameraRays::CameraRays(const Camera& camera, int height_px)
    : perspective_(camera.projection.kind == ProjectionKind::perspective) {
  const Vec3d right = rotate(camera.pose.orientation, {1, 0, 0});
  const Vec3d up = rotate(camera.pose.orientation, {0, 1, 0});
  origin_ = to_float(camera.pose.position_m);
  forward_ = to_float(rotate(camera.pose.orientation, {0, 0, -1}));
  const double half_height = perspective_ ? std::tan(camera.projection.yfov_rad / 2) : camera.projection.ymag_m;
  // Square pixels: the width follows from the frame's shape.
  const double step = 2 * half_height / height_px;
  right_step_ = to_float(right * step);
  up_step_ = to_float(up * step);
  near_ = static_cast<float>(camera.projection.near_m);
  if (camera.projection.far_m > 0) {
    far_ = static_cast<float>(camera.projection.far_m);
  }
  (perspective_ ? spread_ : width_) = static_cast<float>(step);
}

}  // namespace gazetrace
