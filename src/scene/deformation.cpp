// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/deformation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/parallel.hpp"
#include "gazetrace/scene.hpp"
#include "scene/normals_and_tangents.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kBlock = 4096;  // vertices that a thread takes at once

Affine& operator+=(Affine& a, const Affine& b) {
  a.x += b.x;
  a.y += b.y;
  a.z += b.z;
  a.t += b.t;
  return a;
}

Affine scaled(const Affine& a, double s) {
  return {a.x * s, a.y * s, a.z * s, a.t * s};
}

Affine blended(const JointInfluences& influences, const std::vector<Affine>& joints, std::size_t vertex) {
  Affine sum{{}, {}, {}, {}};
  const std::size_t first = vertex * influences.per_vertex;
  for (std::size_t k = first; k < first + influences.per_vertex; ++k) {
    if (influences.weights[k] != 0) {
      sum += scaled(joints[influences.joints[k]], static_cast<double>(influences.weights[k]));
    }
  }
  return sum;
}

// The result points outwards also for mirroring maps.
Vec3d transformed_normal(const Affine& a, const Vec3d& n) {
  const Vec3d turned = cross(a.y, a.z) * n.x + cross(a.z, a.x) * n.y + cross(a.x, a.y) * n.z;
  return determinant(a) < 0 ? -turned : turned;
}

// `v` at length 1, or `otherwise` where `v` has no direction.
Vec3f unit_or(const Vec3d& v, const Vec3f& otherwise) {
  const double len = length(v);
  return len > 0 && std::isfinite(len) ? to_float(v / len) : otherwise;
}

void make_flat(const Geometry& geometry, DeformedVertices& out) {
  for (const auto& triangle : geometry.triangles) {
    const Vec3d a = to_double(out.positions[triangle[0]]);
    const Vec3d face = cross(to_double(out.positions[triangle[1]]) - a, to_double(out.positions[triangle[2]]) - a);
    for (const std::uint32_t vertex : triangle) {
      out.normals[vertex] = unit_or(face, {0, 0, 1});
    }
  }
}

void remake_tangents(const Geometry& geometry, const TextureRef& normal_texture, DeformedVertices& out) {
  Geometry shape;
  shape.positions = out.positions;
  shape.normals = out.normals;
  shape.uv0 = geometry.uv0;
  shape.uv1 = geometry.uv1;
  shape.triangles = geometry.triangles;
  // No vertex is duplicated here: that depends on texture coordinates only, and was done at loading.
  make_tangents(shape, normal_texture);
  out.tangents = std::move(shape.tangents);
}

}  // namespace

DeformedVertices deform(const Geometry& geometry, const MeshPose& pose, const TextureRef& normal_texture, int threads) {
  const std::size_t count = geometry.positions.size();
  const bool has_tangents = geometry.tangents.size() == count && count > 0;
  const bool has_skin = !pose.joints.empty() && geometry.influences.per_vertex > 0;
  DeformedVertices out;
  out.positions.resize(count);
  out.normals.resize(count);
  out.tangents.resize(has_tangents ? count : 0);
  const std::size_t targets = std::min(pose.morph_weights.size(), geometry.morph_targets.size());

  const auto one_vertex = [&](std::size_t i) {
    Vec3d position = to_double(geometry.positions[i]);
    Vec3d normal = to_double(geometry.normals[i]);
    Vec3d tangent =
        has_tangents ? Vec3d{geometry.tangents[i].x, geometry.tangents[i].y, geometry.tangents[i].z} : Vec3d{};
    for (std::size_t k = 0; k < targets; ++k) {
      const double weight = pose.morph_weights[k];
      const MorphTarget& target = geometry.morph_targets[k];
      const auto add = [&](const std::vector<Vec3f>& displacements, Vec3d& to) {
        if (weight != 0 && !displacements.empty()) {
          to += to_double(displacements[i]) * weight;
        }
      };
      add(target.positions, position);
      add(target.normals, normal);
      add(target.tangents, tangent);
    }
    if (has_skin) {
      const Affine map = blended(geometry.influences, pose.joints, i);
      position = transform_point(map, position);
      normal = transformed_normal(map, normal);
      tangent = transform_vector(map, tangent);
    }
    out.positions[i] = to_float(position);
    out.normals[i] = unit_or(normal, geometry.normals[i]);
    if (has_tangents) {
      const Vec3f t = unit_or(tangent, {geometry.tangents[i].x, geometry.tangents[i].y, geometry.tangents[i].z});
      out.tangents[i] = {t.x, t.y, t.z, geometry.tangents[i].w};
    }
  };
  parallel_for((count + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      one_vertex(i);
    }
  });
  if (geometry.flat_normals) {
    make_flat(geometry, out);
  }
  if (geometry.made_tangents && targets > 0) {
    remake_tangents(geometry, normal_texture, out);
  }
  return out;
}

bool is_mirrored(const MeshPose& pose) {
  return !pose.joints.empty() && determinant(pose.joints.front()) < 0;
}

}  // namespace gazetrace
