// SPDX-License-Identifier: Apache-2.0
#include "job/whole_scene_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gazetrace {
namespace {

constexpr double kFilled = 0.94;  // of the frame's width or height

// A point before the camera must not lie beyond the sides of the view: |x - camera x| <= slope (z - camera z), with z
// along the view. This is linear in the camera's place, so of all points only two extremes count.
struct Sides {
  double slope;
  double most = -std::numeric_limits<double>::infinity(), least = -std::numeric_limits<double>::infinity();
  void add(double x, double z) {
    most = std::max(most, x - slope * z);
    least = std::max(least, -x - slope * z);
  }
  [[nodiscard]] double camera_x() const { return (most - least) / 2; }
  [[nodiscard]] double camera_z() const { return -(most + least) / (2 * slope); }
};

template <class Add>
void for_each_point(const Scene& scene, const SceneSummary& summary, const Add& add) {
  if (!scene.deformations.empty()) {  // whose vertices are elsewhere than their meshes say
    for (unsigned corner = 0; corner < 8; ++corner) {
      add(Vec3d{(corner & 1U) != 0 ? summary.bounds_max.x : summary.bounds_min.x,
                (corner & 2U) != 0 ? summary.bounds_max.y : summary.bounds_min.y,
                (corner & 4U) != 0 ? summary.bounds_max.z : summary.bounds_min.z});
    }
    return;
  }
  for (const Instance& instance : scene.instances) {
    for (const Geometry& geometry : scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries) {
      for (const Vec3f& position : geometry.positions) {
        add(transform_point(instance.to_world, {position.x, position.y, position.z}));
      }
    }
  }
}

}  // namespace

CameraPath whole_scene_camera(const Scene& scene, const Projection& projection, double aspect) {
  const Vec3d towards = normalize(Vec3d{-0.5, -0.35, -1.0});
  const Vec3d right = normalize(cross(towards, {0, 1, 0}));
  const Vec3d up = cross(right, towards);
  const double half_height = std::tan(projection.yfov_rad / 2) * kFilled;
  Sides across{half_height * aspect};
  Sides upright{half_height};
  const SceneSummary summary = summarize(scene);
  const bool is_empty = summary.bounds_min.x > summary.bounds_max.x;
  const Vec3d center = is_empty ? Vec3d{} : (summary.bounds_min + summary.bounds_max) * 0.5;
  const auto add = [&](const Vec3d& point) {
    const Vec3d from_center = point - center;  // small numbers, however far out the scene lies
    across.add(dot(from_center, right), dot(from_center, towards));
    upright.add(dot(from_center, up), dot(from_center, towards));
  };
  if (is_empty) {
    add({-1, -1, -1});
    add({1, 1, 1});
  } else {
    for_each_point(scene, summary, add);
  }
  // A point has no size that could fill anything.
  const double radius = is_empty ? 1 : 0.5 * length(summary.bounds_max - summary.bounds_min);
  const double back = std::max(-std::min(across.camera_z(), upright.camera_z()), std::max(radius * 1e-3, 1e-30));
  const Vec3d eye = center + right * across.camera_x() + up * upright.camera_x() - towards * back;
  return static_camera(look_at(eye, eye + towards * std::max(radius, 1e-30), {0, 1, 0}), projection);
}

}  // namespace gazetrace
