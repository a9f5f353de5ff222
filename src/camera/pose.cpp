// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gazetrace/camera.hpp"

namespace gazetrace {
namespace {

Vec3d axis_most_across(const Vec3d& direction) {
  const Vec3d a{std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)};
  // Where axes are equally good, y is preferred, then z, so that a camera that looks along x keeps y up.
  if (a.y <= a.x && a.y <= a.z) {
    return {0, 1, 0};
  }
  return a.z <= a.x ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
}

}  // namespace

CameraPose look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up) {
  Vec3d z = normalize(eye - target);
  if (length(z) == 0) {
    z = {0, 0, 1};
  }
  Vec3d x = cross(normalize(up), z);
  if (!(length(x) > 1e-9)) {
    x = cross(axis_most_across(z), z);
  }
  x = normalize(x);
  return {eye, rotation_of({x, cross(z, x), z, {}})};
}

CameraPath static_camera(const CameraPose& pose, const Projection& projection) {
  CameraPath path;
  path.projection = projection;
  path.pose_at = [pose](std::int64_t) { return pose; };
  return path;
}

double pixel_step_m(const Projection& projection, int height_px) {
  const bool parallel = projection.kind == ProjectionKind::orthographic;
  return 2 * (parallel ? projection.ymag_m : std::tan(projection.yfov_rad / 2)) / height_px;
}

double lens_radius_m(double f_number, double sensor_height_mm, double yfov_rad) {
  const double focal_length_m = sensor_height_mm * 1e-3 / (2 * std::tan(yfov_rad / 2));
  return f_number > 0 ? focal_length_m / (2 * f_number) : 0;
}

}  // namespace gazetrace
