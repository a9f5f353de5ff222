// SPDX-License-Identifier: Apache-2.0
// A triangle in the form that shading reads.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/math.hpp"
#include "gazetrace/scene.hpp"
#include "trace/rays/ray_batch.hpp"

namespace gazetrace {

// Everything that a hit needs, in one and a half cache lines. Triangles of meshes that are used once are in world
// space, others in the mesh's own space. Positions are those that the BVH was built from, so that points on the
// triangle are exact to rounding.
struct alignas(32) ShadingTriangle {
  std::array<Vec3f, 3> position;
  std::array<Vec2f, 3> uv;              // coordinates of the first texture that there is, with its transform applied
  std::array<std::uint32_t, 3> normal;  // octahedral
  std::array<std::uint32_t, 3> tangent;
  float lod = 0;  // log2 of sqrt(uv area / area): Akenine-Moller et al. 2021, eq. 2, without the texture's size
  std::uint32_t bits = 0;       // material << 2 | joints turn it inside out << 1 | bitangent is negated
  std::uint32_t extra = kNoId;  // index into TriangleExtra

  [[nodiscard]] std::uint32_t material() const { return bits >> 2U; }
  // -1 where its corners run clockwise as one sees its front.
  [[nodiscard]] float winding() const { return (bits & 2U) != 0 ? -1.0F : 1.0F; }
  [[nodiscard]] float bitangent_sign() const { return (bits & 1U) != 0 ? -1.0F : 1.0F; }
};
static_assert(sizeof(ShadingTriangle) == 96);

// The part of a triangle that changes with the shape of its mesh.
struct TriangleShape {
  std::array<Vec3f, 3> position;
  std::array<std::uint32_t, 3> normal;
  std::array<std::uint32_t, 3> tangent;
};

// The vertices that the corners of triangles are taken from. Positions are final; normals and tangents (one per vertex,
// or empty) must still be transformed by `to_world`, where there is one.
struct SurfaceVertices {
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<Vec4f>& tangents;
  const Affine* to_world = nullptr;
  const DeformedVertices* shape = nullptr;  // where they are from, for the triangles that it mirrors
};

// Sets everything of a triangle that depends on the positions of its corners; its uv must be set already. Missing
// normals and tangents, and those without a direction, become the flat normal and any tangent.
void shape_triangle(const SurfaceVertices& vertices, const std::array<std::uint32_t, 3>& corner,
                    ShadingTriangle& triangle);

// Checks for coordinates that the ray library would silently leave out. Loading refuses them, but an instance's matrix,
// a pose or a program may still produce them. Error(input) names mesh, primitive and vertex.
void check_positions(const std::vector<Vec3f>& positions, const Scene& scene, std::size_t mesh, std::size_t primitive);

}  // namespace gazetrace
