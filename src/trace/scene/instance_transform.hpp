// SPDX-License-Identifier: Apache-2.0
// Converts an instance's transform to what rays and shading need.
#pragma once

#include <array>
#include <cmath>

#include "gazetrace/math.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

// What leads into a world whose coordinates count from `origin_m`.
inline Affine counted_from(const Vec3d& origin_m, const Affine& to_world) {
  return {to_world.x, to_world.y, to_world.z, to_world.t - origin_m};
}

// The cofactor matrix, which transforms normals for any invertible map; for mirroring ones with the sign of the
// determinant.
inline std::array<Vec3d, 3> cofactors(const Affine& a) {
  return {cross(a.y, a.z), cross(a.z, a.x), cross(a.x, a.y)};
}

inline ShadingInstance shading_instance(const Affine& to_world) {
  ShadingInstance instance;
  instance.axes = {to_float(to_world.x), to_float(to_world.y), to_float(to_world.z)};
  instance.translation = to_float(to_world.t);
  const auto normal_map = cofactors(to_world);
  const double det = determinant(to_world);
  for (std::size_t k = 0; k < 3; ++k) {
    // Divided by |determinant|^(2/3), so that tiny and huge scales stay within float's range.
    instance.normal_axes[k] = to_float(normal_map[k] / (std::copysign(std::pow(std::fabs(det), 2.0 / 3.0), det)));
  }
  instance.flip = det < 0 ? -1.0F : 1.0F;
  instance.lod_offset = static_cast<float>(-std::log2(std::fabs(det)) / 3.0);
  return instance;
}

inline RayTransform ray_transform(const Affine& to_world) {
  RayTransform transform{};
  const std::array<Vec3f, 4> columns{to_float(to_world.x), to_float(to_world.y), to_float(to_world.z),
                                     to_float(to_world.t)};
  for (std::size_t k = 0; k < 4; ++k) {
    transform[3 * k] = columns[k].x;
    transform[3 * k + 1] = columns[k].y;
    transform[3 * k + 2] = columns[k].z;
  }
  return transform;
}

}  // namespace gazetrace
