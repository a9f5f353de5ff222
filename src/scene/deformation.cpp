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

void add_scaled(Vec2f& to, const Vec2f& v, float s) {
  to = {to.x + s * v.x, to.y + s * v.y};
}
void add_scaled(Vec4f& to, const Vec4f& v, float s) {
  to = {to.x + s * v.x, to.y + s * v.y, to.z + s * v.z, to.w + s * v.w};
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
      out.normals[vertex] = unit_or(out.is_mirrored(triangle) ? -face : face, {0, 0, 1});
    }
  }
}

void remake_tangents(const Geometry& geometry, const TextureRef& normal_texture, DeformedVertices& out) {
  Geometry shape;
  shape.positions = out.positions;
  shape.normals = out.normals;
  shape.uv0 = out.uv0.empty() ? geometry.uv0 : out.uv0;
  shape.uv1 = out.uv1.empty() ? geometry.uv1 : out.uv1;
  shape.triangles = geometry.triangles;
  // Vertices between triangles of opposite handedness were duplicated at loading. Where texture coordinates move,
  // others may come to lie so; they stay one.
  make_tangents(shape, normal_texture);
  out.tangents.assign(shape.tangents.begin(),
                      shape.tangents.begin() + static_cast<std::ptrdiff_t>(out.positions.size()));
  for (std::size_t i = 0; i < out.mirrored.size(); ++i) {
    out.tangents[i].w *= out.mirrored[i] != 0 ? -1.0F : 1.0F;
  }
}

// What the targets make of an attribute that is no direction; empty where none of them changes it.
template <class Vec>
std::vector<Vec> morphed(const std::vector<Vec>& base, const Geometry& geometry, const std::vector<double>& weights,
                         std::vector<Vec> MorphTarget::*attribute) {
  std::vector<Vec> sum;
  for (std::size_t k = 0; k < std::min(weights.size(), geometry.morph_targets.size()); ++k) {
    const std::vector<Vec>& added = geometry.morph_targets[k].*attribute;
    if (added.empty() || base.empty() || weights[k] == 0) {
      continue;
    }
    sum = sum.empty() ? base : std::move(sum);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      add_scaled(sum[i], added[i], static_cast<float>(weights[k]));
    }
  }
  return sum;
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
  const auto mirrors = [](const Affine& joint) { return determinant(joint) < 0; };
  out.mirrored.resize(has_skin && std::any_of(pose.joints.begin(), pose.joints.end(), mirrors) ? count : 0);

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
      if (!out.mirrored.empty()) {
        out.mirrored[i] = mirrors(map) ? 1 : 0;
      }
    }
    out.positions[i] = to_float(position);
    out.normals[i] = unit_or(normal, geometry.normals[i]);
    if (has_tangents) {
      const Vec3f t = unit_or(tangent, {geometry.tangents[i].x, geometry.tangents[i].y, geometry.tangents[i].z});
      const bool turned = !out.mirrored.empty() && out.mirrored[i] != 0;
      out.tangents[i] = {t.x, t.y, t.z, turned ? -geometry.tangents[i].w : geometry.tangents[i].w};
    }
  };
  parallel_for((count + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      one_vertex(i);
    }
  });
  out.uv0 = morphed(geometry.uv0, geometry, pose.morph_weights, &MorphTarget::uv0);
  out.uv1 = morphed(geometry.uv1, geometry, pose.morph_weights, &MorphTarget::uv1);
  out.colors = morphed(geometry.colors, geometry, pose.morph_weights, &MorphTarget::colors);
  for (Vec4f& color : out.colors) {
    const auto unit = [](float value) { return std::clamp(value, 0.0F, 1.0F); };
    color = {unit(color.x), unit(color.y), unit(color.z), unit(color.w)};
  }
  if (geometry.flat_normals) {
    make_flat(geometry, out);
  }
  if (geometry.made_tangents && targets > 0) {
    remake_tangents(geometry, normal_texture, out);
  }
  return out;
}

}  // namespace gazetrace
