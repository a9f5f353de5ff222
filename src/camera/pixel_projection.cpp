// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "gazetrace/motion.hpp"

namespace gazetrace {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

}  // namespace

PixelProjection::PixelProjection(const Camera& camera, int width_px, int height_px)
    : perspective_(camera.projection.kind == ProjectionKind::perspective),
      origin_(camera.pose.position_m),
      right_(rotate(camera.pose.orientation, {1, 0, 0})),
      up_(rotate(camera.pose.orientation, {0, 1, 0})),
      forward_(rotate(camera.pose.orientation, {0, 0, -1})),
      center_px_{width_px / 2.0 - camera.middle_px.x, height_px / 2.0 - camera.middle_px.y} {
  step_ = pixel_step_m(camera.projection, height_px);
}

Vec2d PixelProjection::direction(const Vec3d& d) const {
  const double along = dot(d, forward_);
  if (!perspective_ || !(along > 0)) {
    return {kNowhere, kNowhere};
  }
  return {center_px_.x + dot(d, right_) / (step_ * along), center_px_.y - dot(d, up_) / (step_ * along)};
}

}  // namespace gazetrace
