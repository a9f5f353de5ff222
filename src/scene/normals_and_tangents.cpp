// SPDX-License-Identifier: Apache-2.0
#include "scene/normals_and_tangents.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace gazetrace {
namespace {

template <class T>
std::vector<T> gathered(const std::vector<T>& values, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<T> result;
  if (values.empty()) {
    return result;
  }
  result.reserve(triangles.size() * 3);
  for (const auto& triangle : triangles) {
    for (const std::uint32_t index : triangle) {
      result.push_back(values[index]);
    }
  }
  return result;
}

JointInfluences gathered(const JointInfluences& from, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  JointInfluences result;
  result.per_vertex = from.per_vertex;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t vertex : triangle) {
      for (std::uint32_t k = 0; k < from.per_vertex; ++k) {
        result.joints.push_back(from.joints[std::size_t{vertex} * from.per_vertex + k]);
        result.weights.push_back(from.weights[std::size_t{vertex} * from.per_vertex + k]);
      }
    }
  }
  return result;
}

// Twice the area times the normal. In double, so that needle-shaped and tiny triangles keep a direction.
Vec3d area_normal(const Geometry& geometry, const std::array<std::uint32_t, 3>& triangle) {
  const Vec3d a = to_double(geometry.positions[triangle[0]]);
  const Vec3d b = to_double(geometry.positions[triangle[1]]);
  const Vec3d c = to_double(geometry.positions[triangle[2]]);
  return cross(b - a, c - a);
}

Vec3d any_perpendicular(const Vec3d& normal) {
  const Vec3d axis = std::abs(normal.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalize(cross(axis, normal));
}

// The unit vector along the part of `direction` that is perpendicular to `normal`; zero where there is none.
Vec3d in_plane(const Vec3d& direction, const Vec3d& normal) {
  const Vec3d projected = direction - normal * dot(normal, direction);
  const double len = length(projected);
  return len > 1e-9 * length(direction) && len > 0 ? projected / len : Vec3d{};
}

Vec2d transformed_uv(const Geometry& geometry, const TextureRef& texture, std::uint32_t vertex) {
  const std::vector<Vec2f>& set = texture.uv_set == 1 ? geometry.uv1 : geometry.uv0;
  if (set.empty()) {
    return {};
  }
  const Vec2d uv{set[vertex].x, set[vertex].y};
  const auto& m = texture.transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

void append_copy(JointInfluences& influences, std::uint32_t vertex) {
  for (std::uint32_t k = 0; k < influences.per_vertex; ++k) {
    const std::size_t from = std::size_t{vertex} * influences.per_vertex + k;
    influences.joints.push_back(influences.joints[from]);
    influences.weights.push_back(influences.weights[from]);
  }
}

// Appends a copy of a vertex with all its attributes, and returns its index.
std::uint32_t double_vertex(Geometry& geometry, std::uint32_t vertex) {
  const auto copy = [vertex](auto& values) {
    if (!values.empty()) {
      values.push_back(values[vertex]);
    }
  };
  copy(geometry.positions);
  copy(geometry.normals);
  copy(geometry.uv0);
  copy(geometry.uv1);
  copy(geometry.colors);
  append_copy(geometry.influences, vertex);
  for (MorphTarget& target : geometry.morph_targets) {
    copy(target.positions);
    copy(target.normals);
    copy(target.tangents);
    copy(target.uv0);
    copy(target.uv1);
    copy(target.colors);
  }
  return static_cast<std::uint32_t>(geometry.positions.size() - 1);
}

struct UvFrame {
  Vec3d along_u;           // direction of growing u, not normalised; zero where the uvs have no area
  std::int8_t handedness;  // +1 where cross(normal, along_u) points along falling v, else -1
};

UvFrame uv_frame(const Geometry& geometry, const TextureRef& texture, const std::array<std::uint32_t, 3>& triangle) {
  const Vec3d a = to_double(geometry.positions[triangle[0]]);
  const Vec3d e1 = to_double(geometry.positions[triangle[1]]) - a;
  const Vec3d e2 = to_double(geometry.positions[triangle[2]]) - a;
  const Vec2d uv = transformed_uv(geometry, texture, triangle[0]);
  const Vec2d uv1 = transformed_uv(geometry, texture, triangle[1]);
  const Vec2d uv2 = transformed_uv(geometry, texture, triangle[2]);
  const double du1 = uv1.x - uv.x;
  const double dv1 = uv1.y - uv.y;
  const double du2 = uv2.x - uv.x;
  const double dv2 = uv2.y - uv.y;
  const double area = du1 * dv2 - du2 * dv1;
  if (area == 0 || !std::isfinite(area)) {
    return {{}, 0};
  }
  const double sign = area > 0 ? 1.0 : -1.0;
  return {(e1 * dv2 - e2 * dv1) * sign, static_cast<std::int8_t>(area > 0 ? -1 : 1)};
}

// Gives every vertex one handedness by duplicating vertices between triangles that disagree. Returns one entry per
// vertex.
std::vector<std::int8_t> split_by_handedness(Geometry& geometry, const std::vector<UvFrame>& frames) {
  std::vector<std::int8_t> handedness(geometry.positions.size(), 0);
  std::vector<std::uint32_t> other(geometry.positions.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const std::int8_t wanted = frames[t].handedness;
    if (wanted == 0) {
      continue;
    }
    for (std::uint32_t& vertex : geometry.triangles[t]) {
      if (handedness[vertex] == 0) {
        handedness[vertex] = wanted;
      } else if (handedness[vertex] != wanted) {
        if (other[vertex] == std::numeric_limits<std::uint32_t>::max()) {
          other[vertex] = double_vertex(geometry, vertex);
          handedness.push_back(wanted);
          other.push_back(vertex);
        }
        vertex = other[vertex];
      }
    }
  }
  return handedness;
}

}  // namespace

void make_flat_normals(Geometry& geometry) {
  geometry.positions = gathered(geometry.positions, geometry.triangles);
  geometry.uv0 = gathered(geometry.uv0, geometry.triangles);
  geometry.uv1 = gathered(geometry.uv1, geometry.triangles);
  geometry.colors = gathered(geometry.colors, geometry.triangles);
  geometry.influences = gathered(geometry.influences, geometry.triangles);
  for (MorphTarget& target : geometry.morph_targets) {
    target.positions = gathered(target.positions, geometry.triangles);
    target.uv0 = gathered(target.uv0, geometry.triangles);
    target.uv1 = gathered(target.uv1, geometry.triangles);
    target.colors = gathered(target.colors, geometry.triangles);
    target.normals.clear();
    target.tangents.clear();
  }
  geometry.flat_normals = true;
  geometry.normals.resize(geometry.positions.size());
  geometry.tangents.clear();
  for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(3 * t);
    geometry.triangles[t] = {first, first + 1, first + 2};
    const Vec3d normal = normalize(area_normal(geometry, geometry.triangles[t]));
    const Vec3f flat = length(normal) > 0 ? to_float(normal) : Vec3f{0, 0, 1};
    geometry.normals[first] = geometry.normals[first + 1] = geometry.normals[first + 2] = flat;
  }
}

void repair_normals(Geometry& geometry) {
  bool any_zero = false;
  for (Vec3f& normal : geometry.normals) {
    const double square = dot(to_double(normal), to_double(normal));
    if (std::abs(square - 1.0) > 1e-5) {
      normal = to_float(normalize(to_double(normal)));
    }
    any_zero = any_zero || square == 0;
  }
  if (!any_zero) {
    return;
  }
  std::vector<Vec3d> sums(geometry.positions.size());
  for (const auto& triangle : geometry.triangles) {
    const Vec3d normal = area_normal(geometry, triangle);
    for (const std::uint32_t vertex : triangle) {
      sums[vertex] += normal;
    }
  }
  for (std::size_t i = 0; i < geometry.normals.size(); ++i) {
    if (geometry.normals[i] == Vec3f{}) {
      const Vec3d mean = normalize(sums[i]);
      geometry.normals[i] = length(mean) > 0 ? to_float(mean) : Vec3f{0, 0, 1};
    }
  }
}

void make_tangents(Geometry& geometry, const TextureRef& normal_texture) {
  std::vector<UvFrame> frames;
  frames.reserve(geometry.triangles.size());
  for (const auto& triangle : geometry.triangles) {
    frames.push_back(uv_frame(geometry, normal_texture, triangle));
  }
  geometry.made_tangents = true;
  const std::vector<std::int8_t> handedness = split_by_handedness(geometry, frames);
  std::vector<Vec3d> sums(geometry.positions.size());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    if (frames[t].handedness == 0) {
      continue;
    }
    const auto& triangle = geometry.triangles[t];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = triangle[corner];
      const Vec3d at = to_double(geometry.positions[vertex]);
      const Vec3d normal = to_double(geometry.normals[vertex]);
      const Vec3d next = in_plane(to_double(geometry.positions[triangle[(corner + 1) % 3]]) - at, normal);
      const Vec3d previous = in_plane(to_double(geometry.positions[triangle[(corner + 2) % 3]]) - at, normal);
      sums[vertex] += in_plane(frames[t].along_u, normal) * angle_between_rad(next, previous);
    }
  }
  geometry.tangents.resize(geometry.positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Vec3d normal = to_double(geometry.normals[i]);
    Vec3d tangent = in_plane(sums[i], normal);
    if (length(tangent) == 0) {
      tangent = any_perpendicular(normal);
    }
    const Vec3f t = to_float(tangent);
    geometry.tangents[i] = {t.x, t.y, t.z, handedness[i] < 0 ? -1.0F : 1.0F};
  }
}

void repair_tangents(Geometry& geometry) {
  for (std::size_t i = 0; i < geometry.tangents.size(); ++i) {
    Vec4f& tangent = geometry.tangents[i];
    const Vec3d normal = to_double(geometry.normals[i]);
    Vec3d direction = in_plane({tangent.x, tangent.y, tangent.z}, normal);
    if (length(direction) == 0) {
      direction = any_perpendicular(normal);
    }
    const Vec3f t = to_float(direction);
    tangent = {t.x, t.y, t.z, tangent.w < 0 ? -1.0F : 1.0F};
  }
}

}  // namespace gazetrace
