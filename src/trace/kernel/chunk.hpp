// SPDX-License-Identifier: Apache-2.0
// The hits of a few dozen rays as a structure of arrays, so that the compiler vectorises over sixteen lanes. Loops over
// lanes are written for one lane and without branches; lanes past the count hold old, but initialised values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "gazetrace/math.hpp"

namespace gazetrace {

inline constexpr std::size_t kChunk = 64;
inline constexpr std::size_t kLanes = 16;

template <class T>
struct alignas(64) ChunkArray {
  T data[kChunk];
  T& operator[](std::size_t i) { return data[i]; }
  const T& operator[](std::size_t i) const { return data[i]; }
};

struct ChunkVec3 {
  ChunkArray<float> x, y, z;
  [[nodiscard]] Vec3f get(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3f& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

struct ChunkVec2 {
  ChunkArray<float> x, y;
  [[nodiscard]] Vec2f get(std::size_t i) const { return {x[i], y[i]}; }
  void set(std::size_t i, const Vec2f& v) {
    x[i] = v.x;
    y[i] = v.y;
  }
};

// Calls body(i) for i from 0 to count, rounded up to the next multiple of the lanes.
template <class Body>
[[gnu::always_inline]] inline void for_lanes(std::size_t count, const Body& body) {
  for (std::size_t first = 0; first < count; first += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      body(first + lane);
    }
  }
}

struct ChunkHits {
  // The ray, and the indices of its hit's data.
  ChunkVec3 direction;
  ChunkArray<float> u, v, t, cone_width, cone_spread;
  ChunkArray<std::uint32_t> path;      // index into the packed batch
  ChunkArray<std::uint32_t> triangle;  // into RenderScene::triangles
  ChunkArray<std::uint32_t> instance;  // into RenderScene::instances, kNoId: none

  // The triangle, in world space after gather_triangles.
  std::array<ChunkVec3, 3> corner;
  std::array<ChunkVec3, 3> corner_normal;   // of unit length in the mesh's own space, of any length in the world
  std::array<ChunkVec3, 3> corner_tangent;  // any length
  std::array<ChunkVec2, 3> corner_uv;
  ChunkArray<float> lod, bitangent_sign, winding, instance_reach;
  ChunkArray<std::uint32_t> material, extra;

  // The point.
  ChunkVec3 position, geometric, shading;  // the normals are of unit length, on the ray's side
  ChunkVec3 origin;                        // of rays that leave: the position, moved off the surface
  ChunkVec3 tangent;
  ChunkVec3 smooth;  // interpolated normal, neither bumped nor turned to the ray; only with layers
  ChunkVec2 uv;
  ChunkArray<float> offset, side, good;
  ChunkVec3 base_color;
  ChunkArray<float> metallic, roughness;
  ChunkVec3 texel_normal;  // -1..1, scaled
  ChunkArray<float> has_normal;

  // The scattering event; directions are in the local frame about `shading` until it is finished.
  ChunkVec3 view;
  ChunkVec3 light;                  // direction of the light sample, first in the world, then in the local frame
  ChunkVec3 lit_point, lit_normal;  // arguments of LightSampler; only where it depends_on_place
  ChunkArray<float> table_fraction, e_average;
  ChunkArray<std::int32_t> table_row;
  std::array<ChunkArray<float>, 4> view_terms, light_terms, next_terms;  // AlbedoTerms e, b, lambert, burley
  ChunkVec3 half;
  ChunkVec3 light_f_cos;
  ChunkArray<float> light_pdf;  // density of the BSDF towards the light
  ChunkVec2 random;
  ChunkArray<float> random_lobe;
  ChunkVec3 next, next_weight;  // the BSDF sample
  ChunkArray<float> next_pdf, next_good;
  // Only with FrameContext::guiding_field: the cell of GuidingField, the share of its table in the choice of a
  // direction (the cell's own until evaluate_lanes has multiplied it by the probability of the diffuse lobe), and
  // whether the direction is the table's.
  ChunkArray<std::int32_t> cell;
  ChunkArray<float> table_share;
  ChunkArray<float> next_bsdf_pdf;  // density of the BSDF alone towards `next`; set only where table_share > 0
  ChunkArray<std::uint8_t> by_table;
  // Of camera rays' hits, what the diffuse lobe has of light_f_cos and next_weight, 0..1; only with light groups.
  ChunkVec3 light_diffuse, next_diffuse;
};

}  // namespace gazetrace
