// SPDX-License-Identifier: Apache-2.0
#include "trace/scene/shading_triangle.hpp"

#include <cmath>

#include "gazetrace/error.hpp"
#include "trace/rays/embree.hpp"
#include "trace/scene/instance_transform.hpp"
#include "trace/scene/octahedral.hpp"

namespace gazetrace {
namespace {

Vec3d transform_normal(const std::array<Vec3d, 3>& columns, const Vec3d& v) {
  return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
}

// Any tangent, for triangles whose texture coordinates give none.
Vec3d some_tangent(const Vec3d& n) {
  const Vec3d axis = std::fabs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalize(cross(axis, n));
}

}  // namespace

void shape_triangle(const SurfaceVertices& vertices, const std::array<std::uint32_t, 3>& corner,
                    ShadingTriangle& triangle) {
  const Affine* to_world = vertices.to_world;
  const auto normal_map = to_world != nullptr ? cofactors(*to_world) : cofactors(Affine{});
  const double normal_sign = to_world != nullptr && determinant(*to_world) < 0 ? -1.0 : 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.position[k] = vertices.positions[corner[k]];
  }
  const Vec3d e1 = to_double(triangle.position[1]) - to_double(triangle.position[0]);
  const Vec3d e2 = to_double(triangle.position[2]) - to_double(triangle.position[0]);
  const bool mirrored = vertices.shape != nullptr && vertices.shape->is_mirrored(corner);
  const Vec3d face = cross(e1, e2) * (mirrored ? -1.0 : 1.0);
  const double twice_area = length(face);
  const Vec3d flat = twice_area > 0 ? face / twice_area : Vec3d{0, 0, 1};
  const Vec2f& a = triangle.uv[0];
  const Vec2d d1{static_cast<double>(triangle.uv[1].x) - a.x, static_cast<double>(triangle.uv[1].y) - a.y};
  const Vec2d d2{static_cast<double>(triangle.uv[2].x) - a.x, static_cast<double>(triangle.uv[2].y) - a.y};
  const double twice_uv_area = d1.x * d2.y - d1.y * d2.x;
  triangle.lod = -100.0F;
  if (twice_area > 0 && std::isfinite(twice_uv_area) && twice_uv_area != 0) {
    triangle.lod = static_cast<float>(0.5 * std::log2(std::fabs(twice_uv_area) / twice_area));
  }
  float sign = (twice_uv_area < 0) != mirrored ? -1.0F : 1.0F;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = corner[k];
    Vec3d n = flat;
    if (vertex < vertices.normals.size()) {
      const Vec3d given = normalize(transform_normal(normal_map, to_double(vertices.normals[vertex])) * normal_sign);
      if (is_finite(given) && dot(given, given) > 0) {
        n = given;
      }
    }
    triangle.normal[k] = encode_octahedral(to_float(n));
    Vec3d t;
    if (vertex < vertices.tangents.size()) {
      const Vec4f& given = vertices.tangents[vertex];
      t = to_double(Vec3f{given.x, given.y, given.z});
      t = normalize(to_world != nullptr ? transform_vector(*to_world, t) : t);
      sign = given.w * static_cast<float>(normal_sign);
    } else if (twice_uv_area != 0) {
      t = normalize((e1 * d2.y - e2 * d1.y) / twice_uv_area);
    }
    if (!is_finite(t) || dot(t, t) == 0) {
      t = some_tangent(n);
    }
    triangle.tangent[k] = encode_octahedral(to_float(t));
  }
  triangle.bits = (triangle.bits & ~3U) | (mirrored ? 2U : 0U) | (sign < 0 ? 1U : 0U);
}

void check_positions(const std::vector<Vec3f>& positions, const Scene& scene, std::size_t mesh, std::size_t primitive) {
  const auto usable = [](float x) { return std::fabs(x) <= kLargestCoordinate; };  // false for NaN, too
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f& p = positions[i];
    if (!usable(p.x) || !usable(p.y) || !usable(p.z)) {
      throw Error(ErrorKind::input, scene.source,
                  "mesh " + std::to_string(mesh) + " '" + scene.meshes[mesh].name + "', primitive " +
                      std::to_string(primitive) + ": vertex " + std::to_string(i) +
                      " is not finite, or beyond 1e18 m in the world",
                  "repair the model, or the scale of its nodes");
    }
  }
}

}  // namespace gazetrace
