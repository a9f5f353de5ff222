// SPDX-License-Identifier: Apache-2.0
// A gaze direction in the metric's own angles.
#pragma once

#include <cmath>

#include "gazetrace/fovvideovdp.hpp"

namespace gazetrace {

// Azimuth and elevation, in degrees. A direction that never meets the plane of the view counts as far beside it.
inline Vec2f metric_gaze_deg(const PlanarView& view, const FovVideoVdpGeometry& geometry, const Vec3d& direction) {
  constexpr float kFarthest = 90;
  const Vec2d at = view.pixel(direction);
  if (!std::isfinite(at.x) || !std::isfinite(at.y)) {
    return {kFarthest, kFarthest};
  }
  const Vec2d deg = geometry.view_direction_deg(at.x, at.y, view.width_px, view.height_px);
  return {static_cast<float>(deg.x), static_cast<float>(deg.y)};
}

}  // namespace gazetrace
