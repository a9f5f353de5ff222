// SPDX-License-Identifier: Apache-2.0
// A triangle as shading reads it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/math.hpp"
#include "gazetrace/scene.hpp"
#include "trace/rays/ray_batch.hpp"

namespace gazetrace {

// All a hit needs in one and a half cache lines. Triangles of meshes used once are in world space, others in the
// mesh's own. Positions are those the BVH was built from, so that points on the triangle are exact to rounding.
struct alignas(32) ShadingTriangle {
  std::array<Vec3f, 3> position;
  std::array<Vec2f, 3> uv;              // of the base colour's texture (first present one), its transform applied
  std::array<std::uint32_t, 3> normal;  // octahedral
  std::array<std::uint32_t, 3> tangent;
  float lod = 0;  // log2 of sqrt(uv area / area): Akenine-Moller et al. 2021, eq. 2, without the texture's size
  std::uint32_t material_and_sign = 0;  // material << 1 | bitangent is negated
  std::uint32_t extra = kNoId;          // index into TriangleExtra
};
static_assert(sizeof(ShadingTriangle) == 96);

// The part of it that changes with its mesh's shape.
struct TriangleShape {
  std::array<Vec3f, 3> position;
  std::array<std::uint32_t, 3> normal;
  std::array<std::uint32_t, 3> tangent;
};

// What the corners of triangles are taken from. Positions are final; normals and tangents, empty or one a vertex, are
// still to be transformed by `to_world` where there is one.
struct SurfaceVertices {
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<Vec4f>& tangents;
  const Affine* to_world = nullptr;
};

// Everything of a triangle that follows from its corners' places; its uv must be there already. What is missing or has
// no direction gets a flat normal and any tangent.
void shape_triangle(const SurfaceVertices& vertices, const std::array<std::uint32_t, 3>& corner,
                    ShadingTriangle& triangle);

// Loading refuses coordinates that the ray library would leave out without a word; an instance's matrix, a pose or a
// program may still make them. Error(input) names mesh, primitive and vertex.
void check_positions(const std::vector<Vec3f>& positions, const Scene& scene, std::size_t mesh, std::size_t primitive);

}  // namespace gazetrace
