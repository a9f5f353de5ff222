// SPDX-License-Identifier: Apache-2.0
// Computes the values that shading needs from the barycentric coordinates of a hit.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/instruction_sets.hpp"
#include "trace/kernel/chunk.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/kernel/shading_frame.hpp"
#include "trace/scene/octahedral.hpp"

namespace gazetrace {

// log2 with an error of up to 0.01, for mip levels.
inline float rough_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(bits >> 23U) - 128);
  return exponent + ((-1.0F / 3.0F) * mantissa + 2.0F) * mantissa - 2.0F / 3.0F;
}

inline Vec3f interpolate(const std::array<ChunkVec3, 3>& a, std::size_t i, float w, float u, float v) {
  return a[0].get(i) * w + a[1].get(i) * u + a[2].get(i) * v;
}

inline Vec3f apply_columns(const std::array<Vec3f, 3>& columns, const Vec3f& p) {
  return columns[0] * p.x + columns[1] * p.y + columns[2] * p.z;
}

// The texture coordinates of a lane's hit.
inline Vec2f coordinates_at(const RenderScene& scene, const ChunkHits& chunk, std::size_t i,
                            const ShadingTexture& texture) {
  if (texture.own_uv && chunk.extra[i] != kNoId) {
    const TriangleExtra& extra = scene.extras[chunk.extra[i]];
    const auto& set = texture.uv_set == 1 ? extra.uv1 : extra.uv0;
    const float u = chunk.u[i];
    const float v = chunk.v[i];
    const float w = 1.0F - u - v;
    const float x = w * set[0].x + u * set[1].x + v * set[2].x;
    const float y = w * set[0].y + u * set[1].y + v * set[2].y;
    const auto& m = texture.transform;
    return {m[0] * x + m[1] * y + m[2], m[3] * x + m[4] * y + m[5]};
  }
  return chunk.uv.get(i);
}

// The level of detail at a lane's hit; call it after place_hits. ChunkHits::lod is the level for the coordinates that
// are stored in the triangle; for others it differs by the ratio of the triangle's areas in the two textures.
inline float level_at(const RenderScene& scene, const ChunkHits& chunk, std::size_t i, const ShadingTexture& texture) {
  const float level = chunk.lod[i] + texture.half_log2_texels;
  if (texture.own_uv && chunk.extra[i] != kNoId) {
    const auto area = [](const Vec2f& a, const Vec2f& b, const Vec2f& c) {
      return std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    };
    const TriangleExtra& extra = scene.extras[chunk.extra[i]];
    const auto& set = texture.uv_set == 1 ? extra.uv1 : extra.uv0;
    const auto& m = texture.transform;
    const float own = area(set[0], set[1], set[2]) * std::fabs(m[0] * m[4] - m[1] * m[3]);
    const float stored = area(chunk.corner_uv[0].get(i), chunk.corner_uv[1].get(i), chunk.corner_uv[2].get(i));
    if (own > 0 && stored > 0) {
      return level + 0.5F * std::log2(own / stored);
    }
  }
  return level;
}

// Finds the data of hit k of the packed batch and prefetches them.
inline void locate_hit(const RenderScene& scene, const HitBatch& hits, std::size_t k, ChunkHits& chunk, std::size_t i) {
  std::uint32_t record = hits.geometry[k];
  chunk.instance[i] = kNoId;
  if (hits.instance[k] != kNoId) {
    chunk.instance[i] = hits.instance[k] - scene.first_instance_id;
    record += scene.instances[chunk.instance[i]].first_geometry;
  }
  const std::uint32_t triangle = scene.geometries[record].first_triangle + hits.primitive[k];
  chunk.triangle[i] = triangle;
  chunk.path[i] = static_cast<std::uint32_t>(k);
  const auto* data = reinterpret_cast<const char*>(&scene.triangles[triangle]);
  __builtin_prefetch(data);
  __builtin_prefetch(data + 64);
}

// Copies triangles into lanes, and transforms instanced ones to world space. `times` are those of the packed rays, read
// only where something moves while the shutter is open.
GAZETRACE_CLONES inline void gather_triangles(const RenderScene& scene, const BatchArray<float>& times,
                                              ChunkHits& chunk, std::size_t count) {
  std::array<ChunkArray<std::uint32_t>, 3> normal_code;
  std::array<ChunkArray<std::uint32_t>, 3> tangent_code;
  for (std::size_t i = 0; i < count; ++i) {
    const ShadingTriangle& triangle = scene.triangles[chunk.triangle[i]];
    for (std::size_t c = 0; c < 3; ++c) {
      chunk.corner[c].set(i, triangle.position[c]);
      chunk.corner_uv[c].set(i, triangle.uv[c]);
      normal_code[c][i] = triangle.normal[c];
      tangent_code[c][i] = triangle.tangent[c];
    }
    chunk.lod[i] = triangle.lod;
    chunk.material[i] = triangle.material();
    chunk.bitangent_sign[i] = triangle.bitangent_sign();
    chunk.extra[i] = triangle.extra;
    chunk.winding[i] = triangle.winding();
    chunk.instance_reach[i] = 0;
  }
  const std::size_t padded = std::min((count + kLanes - 1) / kLanes * kLanes, kChunk);
  for (std::size_t c = 0; c < 3; ++c) {
    std::fill(normal_code[c].data + count, normal_code[c].data + padded, 0U);
    std::fill(tangent_code[c].data + count, tangent_code[c].data + padded, 0U);
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          chunk.corner_normal[c].set(i, fast_normalize(decode_octahedral(normal_code[c][i])));
        });
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          chunk.corner_tangent[c].set(i, decode_octahedral(tangent_code[c][i]));
        });
  }
  const auto absolute = [](const Vec3f& a) { return Vec3f{std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; };
  const auto bring_to_world = [&](std::size_t i, const ShadingInstance& instance) {
    Vec3f reach;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f own = chunk.corner[c].get(i);
      const Vec3f far = absolute(own);
      reach = {std::max(reach.x, far.x), std::max(reach.y, far.y), std::max(reach.z, far.z)};
      chunk.corner[c].set(i, apply_columns(instance.axes, own) + instance.translation);
      chunk.corner_normal[c].set(i, apply_columns(instance.normal_axes, chunk.corner_normal[c].get(i)));
      chunk.corner_tangent[c].set(i, apply_columns(instance.axes, chunk.corner_tangent[c].get(i)));
    }
    const Vec3f far = absolute(instance.axes[0]) * reach.x + absolute(instance.axes[1]) * reach.y +
                      absolute(instance.axes[2]) * reach.z + absolute(instance.translation);
    // Twice the rounding errors, since the ray is transformed to the mesh's space and back.
    chunk.instance_reach[i] = 2 * largest(far);
    chunk.winding[i] *= instance.flip;
    chunk.bitangent_sign[i] *= instance.flip;
    chunk.lod[i] += instance.lod_offset;
  };
  for (std::size_t i = 0; i < count && !scene.blurs; ++i) {
    if (chunk.instance[i] != kNoId) {
      bring_to_world(i, scene.instances[chunk.instance[i]]);
    }
  }
  for (std::size_t i = 0; i < count && scene.blurs; ++i) {
    if (chunk.instance[i] != kNoId) {
      const float time = times[chunk.path[i]];
      const ShadingInstance instance = scene.instance_at(chunk.instance[i], time);
      if (instance.shape_way != kNoId) {
        const ShapeWay::Corners corners = scene.shape_ways[instance.shape_way].at(chunk.triangle[i], time);
        for (std::size_t c = 0; c < 3; ++c) {
          chunk.corner[c].set(i, corners.position[c]);
          chunk.corner_normal[c].set(i, corners.normal[c]);
          chunk.corner_tangent[c].set(i, corners.tangent[c]);
        }
      }
      bring_to_world(i, instance);
    }
  }
}

// Computes position, normals, texture coordinates and texture level of every lane.
GAZETRACE_CLONES inline void place_hits(ChunkHits& chunk, std::size_t count) {
  for_lanes(
      count, [&](std::size_t i) __attribute__((always_inline)) {
        const float u = chunk.u[i];
        const float v = chunk.v[i];
        const float w = 1.0F - u - v;
        const Vec3f p0 = chunk.corner[0].get(i);
        const Vec3f p1 = chunk.corner[1].get(i);
        const Vec3f p2 = chunk.corner[2].get(i);
        const Vec3f position = p0 * w + p1 * u + p2 * v;
        // Scaled by the longer edge, so that the normal's length neither underflows nor overflows at any scene scale.
        const Vec3f e1 = p1 - p0;
        const Vec3f e2 = p2 - p0;
        const float edge = chunk.winding[i] / std::max(std::max(largest(e1), largest(e2)), 1e-30F);
        const Vec3f face = cross(e1 * edge, e2 * std::fabs(edge));
        const float face2 = dot(face, face);
        const Vec3f flat = face * (1.0F / std::sqrt(std::max(face2, 1e-30F)));
        const Vec3f smooth = interpolate(chunk.corner_normal, i, w, u, v);
        const float smooth2 = dot(smooth, smooth);
        const bool has_smooth = smooth2 > 1e-12F;
        const float scale = 1.0F / std::sqrt(has_smooth ? smooth2 : 1.0F);
        const Vec3f direction = chunk.direction.get(i);
        const float cosine = dot(flat, direction);
        const float side = cosine < 0 ? 1.0F : -1.0F;
        const Vec3f geometric = flat * side;
        const Vec3f extent{std::max(std::max(std::fabs(p0.x), std::fabs(p1.x)), std::fabs(p2.x)),
                           std::max(std::max(std::fabs(p0.y), std::fabs(p1.y)), std::fabs(p2.y)),
                           std::max(std::max(std::fabs(p0.z), std::fabs(p1.z)), std::fabs(p2.z))};
        const float across = std::fabs(flat.x) * extent.x + std::fabs(flat.y) * extent.y + std::fabs(flat.z) * extent.z;
        const float offset = std::max(across, std::max(largest(position), chunk.instance_reach[i])) * kOffsetUlps;
        chunk.good[i] = face2 > 1e-30F ? 1.0F : 0.0F;
        chunk.side[i] = side;
        chunk.offset[i] = offset;
        chunk.position.set(i, position);
        chunk.geometric.set(i, geometric);
        chunk.origin.set(i, position + geometric * offset);
        chunk.shading.set(i, {has_smooth ? smooth.x * scale : flat.x, has_smooth ? smooth.y * scale : flat.y,
                              has_smooth ? smooth.z * scale : flat.z});
        const float width = chunk.cone_width[i] + chunk.cone_spread[i] * chunk.t[i];
        chunk.cone_width[i] = width;
        const float slant = std::max(std::fabs(cosine), 0.05F);
        chunk.lod[i] += rough_log2(std::max(width, 1e-30F) / slant);
        const Vec2f a = chunk.corner_uv[0].get(i);
        const Vec2f b = chunk.corner_uv[1].get(i);
        const Vec2f c = chunk.corner_uv[2].get(i);
        chunk.uv.set(i, {w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y});
        chunk.tangent.set(i, interpolate(chunk.corner_tangent, i, w, u, v));
      });
}

// Reads the material's values, including textures.
inline void read_materials(const RenderScene& scene, ChunkHits& chunk, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const ShadingMaterial& material = scene.materials[chunk.material[i]];
    Vec3f base{material.base_color.x, material.base_color.y, material.base_color.z};
    float metallic = material.metallic;
    float roughness = material.roughness;
    chunk.has_normal[i] = 0;
    if (chunk.extra[i] != kNoId) {
      const auto& c = scene.extras[chunk.extra[i]].color;
      const float u = chunk.u[i];
      const float v = chunk.v[i];
      const float w = 1.0F - u - v;
      base *= Vec3f{w * c[0].x + u * c[1].x + v * c[2].x, w * c[0].y + u * c[1].y + v * c[2].y,
                    w * c[0].z + u * c[1].z + v * c[2].z};
    }
    TexelValues texel;
    for (std::size_t g = 0; g < material.group_count; ++g) {
      const TexelGroup& group = material.groups[g];
      const Vec2f at = coordinates_at(scene, chunk, i, group.coordinates);
      read_group(group, at.x, at.y, level_at(scene, chunk, i, group.coordinates), texel);
    }
    base *= texel.base;
    metallic *= texel.metallic;
    roughness *= texel.roughness;
    if (material.normal.texture != nullptr) {
      chunk.has_normal[i] = 1;
      chunk.texel_normal.set(i, {(2.0F * texel.normal.x - 1.0F) * material.normal_scale,
                                 (2.0F * texel.normal.y - 1.0F) * material.normal_scale, 2.0F * texel.normal.z - 1.0F});
    }
    chunk.base_color.set(i, base);
    chunk.metallic[i] = metallic;
    chunk.roughness[i] = roughness;
  }
}

// Applies the normal map, turns the normal to the ray's side and keeps its mirror direction above the surface.
GAZETRACE_CLONES inline void finish_normals(ChunkHits& chunk, std::size_t count) {
  for_lanes(
      count, [&](std::size_t i) __attribute__((always_inline)) {
        Vec3f shading = chunk.shading.get(i);
        const Vec3f tangent = chunk.tangent.get(i);
        const Vec3f across = tangent - shading * dot(tangent, shading);
        const float across2 = dot(across, across);
        const Vec3f t = across * (1.0F / std::sqrt(std::max(across2, 1e-20F)));
        const Vec3f b = cross(shading, t) * chunk.bitangent_sign[i];
        const Vec3f texel = chunk.texel_normal.get(i);
        const Vec3f bumped = t * texel.x + b * texel.y + shading * texel.z;
        const float bumped2 = dot(bumped, bumped);
        const float scale = 1.0F / std::sqrt(std::max(bumped2, 1e-20F));
        const bool take = (static_cast<int>(chunk.has_normal[i] != 0) & static_cast<int>(across2 > 1e-20F) &
                           static_cast<int>(bumped2 > 1e-12F)) != 0;
        shading = {take ? bumped.x * scale : shading.x, take ? bumped.y * scale : shading.y,
                   take ? bumped.z * scale : shading.z};
        chunk.shading.set(i, bend_normal(shading * chunk.side[i], chunk.geometric.get(i), -chunk.direction.get(i)));
      });
}

}  // namespace gazetrace
