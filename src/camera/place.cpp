// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "gazetrace/camera.hpp"

namespace gazetrace {

Projection fit_projection(Projection projection, int width_px, int height_px) {
  const double wanted_px = projection.aspect * height_px;
  if (wanted_px > width_px + 0.5) {
    const double more = wanted_px / width_px;
    projection.ymag_m *= more;
    projection.yfov_rad = 2 * std::atan(std::tan(0.5 * projection.yfov_rad) * more);
  }
  projection.aspect = 0;
  return projection;
}

CameraPath place_camera(CameraPath path, const CameraPlacement& placement) {
  if (placement == CameraPlacement{}) {
    return path;
  }
  if (!(placement.scale > 0) || !std::isfinite(placement.scale)) {
    throw Error(ErrorKind::usage, "", fmt::format("a camera path's scale of {} is not positive", placement.scale),
                "give metres per unit of the path");
  }
  if (!std::isfinite(placement.turn_deg) || (placement.start_m && !is_finite(*placement.start_m))) {
    throw Error(ErrorKind::usage, "", "the place of a camera path is not finite", "check its turn and its start");
  }
  const double half = 0.5 * placement.turn_deg * kRadPerDeg;
  const double h = std::sqrt(0.5);
  const Quatd up = placement.z_up ? Quatd{-h, 0, 0, h} : Quatd{};
  const Quatd turn = normalize(Quatd{0, std::sin(half), 0, std::cos(half)} * up);
  const auto turned = [turn, scale = placement.scale](const Vec3d& p) { return scale * rotate(turn, p); };
  const Vec3d move =
      placement.start_m ? *placement.start_m - turned(path.pose_at(path.begin_ns).position_m) : Vec3d{0, 0, 0};
  path.pose_at = [inner = std::move(path.pose_at), turn, turned, move](std::int64_t t_ns) {
    const CameraPose pose = inner(t_ns);
    return CameraPose{turned(pose.position_m) + move, normalize(turn * pose.orientation)};
  };
  return path;
}

}  // namespace gazetrace
