// SPDX-License-Identifier: Apache-2.0
// From a hit's barycentric coordinates to the values that shading needs.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "material/bsdf.hpp"
#include "trace/kernel.hpp"
#include "trace/octahedral.hpp"
#include "trace/shading_frame.hpp"

namespace gazetrace {

struct SurfaceHit {
  Vec3f position;
  Vec3f geometric, shading;  // unit, on the side the ray came from
  float offset = 0;          // how far along `geometric` the next ray starts
  bool front = true;
  bool good = true;  // false: the triangle is too thin for a normal
  const ShadingMaterial* material = nullptr;
  Surface surface;
  Vec3f emission;  // towards the ray, zero on dark sides
  float cone_width = 0;
};

// log2 to 0.01, for mip levels.
inline float rough_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(bits >> 23U) - 128);
  return exponent + ((-1.0F / 3.0F) * mantissa + 2.0F) * mantissa - 2.0F / 3.0F;
}

inline Vec3f interpolate(const std::array<Vec3f, 3>& a, float w, float u, float v) {
  return a[0] * w + a[1] * u + a[2] * v;
}

inline Vec3f apply_columns(const std::array<Vec3f, 3>& columns, const Vec3f& p) {
  return columns[0] * p.x + columns[1] * p.y + columns[2] * p.z;
}

inline float largest(const Vec3f& a) {
  return std::max(std::max(std::fabs(a.x), std::fabs(a.y)), std::fabs(a.z));
}

// Reads one texture at the hit.
struct TextureCoordinates {
  Vec2f uv;
  float lod = 0;  // texture size apart
  const TriangleExtra* extra = nullptr;
  float w = 0, u = 0, v = 0;

  template <KernelFeatures kFeatures>
  [[nodiscard]] Vec2f at(const ShadingTexture& texture) const {
    if constexpr (kFeatures.extras) {
      if (texture.own_uv && extra != nullptr) {
        const auto& set = texture.uv_set == 1 ? extra->uv1 : extra->uv0;
        const float x = w * set[0].x + u * set[1].x + v * set[2].x;
        const float y = w * set[0].y + u * set[1].y + v * set[2].y;
        const auto& m = texture.transform;
        return {m[0] * x + m[1] * y + m[2], m[3] * x + m[4] * y + m[5]};
      }
    }
    return uv;
  }
};

// Where a hit's data are; asks the memory for them.
struct HitPlace {
  std::uint32_t triangle;
  std::uint32_t instance;  // index into RenderScene::instances, kNoId: none
};

template <KernelFeatures kFeatures>
HitPlace place_of_hit(const RenderScene& scene, const HitBatch& hits, std::size_t k) {
  HitPlace place{0, kNoId};
  std::uint32_t record = hits.geometry[k];
  if constexpr (kFeatures.instances) {
    if (hits.instance[k] != kNoId) {
      place.instance = hits.instance[k] - scene.first_instance_id;
      record += scene.instances[place.instance].first_geometry;
    }
  }
  place.triangle = scene.geometries[record].first_triangle + hits.primitive[k];
  const auto* data = reinterpret_cast<const char*>(&scene.triangles[place.triangle]);
  __builtin_prefetch(data);
  __builtin_prefetch(data + 64);
  return place;
}

template <KernelFeatures kFeatures>
void resolve_hit(const RenderScene& scene, const HitPlace& place, const HitBatch& hits, std::size_t k,
                 const Vec3f& direction, float cone_width, float cone_spread, SurfaceHit& hit) {
  const float u = hits.u[k];
  const float v = hits.v[k];
  const float w = 1.0F - u - v;
  const ShadingTriangle& triangle = scene.triangles[place.triangle];
  const ShadingInstance* instance = nullptr;
  if constexpr (kFeatures.instances) {
    if (place.instance != kNoId) {
      instance = &scene.instances[place.instance];
    }
  }
  const auto& p = triangle.position;
  hit.position = interpolate(p, w, u, v);
  // Scaled to the longer edge, so that the normal's length neither under- nor overflows at any scene scale.
  const Vec3f e1 = p[1] - p[0];
  const Vec3f e2 = p[2] - p[0];
  const float edge = 1.0F / std::max(std::max(largest(e1), largest(e2)), 1e-30F);
  Vec3f geometric = cross(e1 * edge, e2 * edge);
  const Vec3f reach{std::max(std::max(std::fabs(p[0].x), std::fabs(p[1].x)), std::fabs(p[2].x)),
                    std::max(std::max(std::fabs(p[0].y), std::fabs(p[1].y)), std::fabs(p[2].y)),
                    std::max(std::max(std::fabs(p[0].z), std::fabs(p[1].z)), std::fabs(p[2].z))};
  Vec3f shading = fast_normalize(decode_octahedral(triangle.normal[0])) * w +
                  fast_normalize(decode_octahedral(triangle.normal[1])) * u +
                  fast_normalize(decode_octahedral(triangle.normal[2])) * v;
  float lod = triangle.lod;
  hit.offset = std::max(std::max(reach.x, reach.y), reach.z) * kOffsetUlps;
  if constexpr (kFeatures.instances) {
    if (instance != nullptr) {
      hit.position = apply_columns(instance->axes, hit.position) + instance->translation;
      geometric = apply_columns(instance->normal_axes, geometric);
      shading = apply_columns(instance->normal_axes, shading);
      const auto absolute = [](const Vec3f& a) { return Vec3f{std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; };
      const Vec3f far = absolute(instance->axes[0]) * reach.x + absolute(instance->axes[1]) * reach.y +
                        absolute(instance->axes[2]) * reach.z + absolute(instance->translation);
      // The ray goes into the mesh's space and back: twice the roundings.
      hit.offset = 2 * std::max(std::max(far.x, far.y), far.z) * kOffsetUlps;
      lod += instance->lod_offset;
    }
  }
  const float length2 = dot(geometric, geometric);
  const float shading2 = dot(shading, shading);
  hit.good = length2 > 1e-30F;
  geometric = geometric * (1.0F / std::sqrt(length2));
  hit.material = &scene.materials[triangle.material_and_sign >> 1U];
  const ShadingMaterial& material = *hit.material;
  hit.front = dot(geometric, direction) < 0;
  const float side = hit.front ? 1.0F : -1.0F;
  hit.geometric = geometric * side;
  shading = shading2 > 1e-12F ? shading * (1.0F / std::sqrt(shading2)) : geometric;

  hit.surface.base_color = {material.base_color.x, material.base_color.y, material.base_color.z};
  hit.surface.metallic = material.metallic;
  hit.surface.roughness = material.roughness;
  hit.cone_width = cone_width + cone_spread * hits.t[k];
  const bool shines = hit.front || material.double_sided;
  if constexpr (kFeatures.emission) {
    hit.emission = shines ? material.emission : Vec3f{};
  }
  TextureCoordinates coordinates;
  if constexpr (kFeatures.extras) {
    if (triangle.extra != kNoId) {
      coordinates.extra = &scene.extras[triangle.extra];
      const auto& c = coordinates.extra->color;
      hit.surface.base_color *= Vec3f{w * c[0].x + u * c[1].x + v * c[2].x, w * c[0].y + u * c[1].y + v * c[2].y,
                                      w * c[0].z + u * c[1].z + v * c[2].z};
    }
  }
  if constexpr (kFeatures.textures) {
    coordinates.uv = {w * triangle.uv[0].x + u * triangle.uv[1].x + v * triangle.uv[2].x,
                      w * triangle.uv[0].y + u * triangle.uv[1].y + v * triangle.uv[2].y};
    coordinates.w = w;
    coordinates.u = u;
    coordinates.v = v;
    const float slant = std::max(std::fabs(dot(geometric, direction)), 0.05F);
    coordinates.lod = lod + rough_log2(std::max(hit.cone_width, 1e-30F) / slant);
    TexelValues texel;
    for (std::size_t g = 0; g < material.group_count; ++g) {
      const TexelGroup& group = material.groups[g];
      const Vec2f at = coordinates.at<kFeatures>(group.coordinates);
      read_group(group, at.x, at.y, coordinates.lod + group.half_log2_texels, texel);
    }
    hit.surface.base_color *= texel.base;
    hit.surface.roughness *= texel.roughness;
    hit.surface.metallic *= texel.metallic;
    if (material.normal.texture != nullptr) {
      const Vec3f& c = texel.normal;
      Vec3f tangent = decode_octahedral(triangle.tangent[0]) * w + decode_octahedral(triangle.tangent[1]) * u +
                      decode_octahedral(triangle.tangent[2]) * v;
      float sign = (triangle.material_and_sign & 1U) != 0 ? -1.0F : 1.0F;
      if constexpr (kFeatures.instances) {
        if (instance != nullptr) {
          tangent = apply_columns(instance->axes, tangent);
          sign *= instance->flip;
        }
      }
      const Vec3f across = tangent - shading * dot(tangent, shading);
      const float across2 = dot(across, across);
      if (across2 > 1e-20F) {
        const Vec3f t = across * (1.0F / std::sqrt(across2));
        const Vec3f b = cross(shading, t) * sign;
        const Vec3f bumped = t * ((2.0F * c.x - 1.0F) * material.normal_scale) +
                             b * ((2.0F * c.y - 1.0F) * material.normal_scale) + shading * (2.0F * c.z - 1.0F);
        const float bumped2 = dot(bumped, bumped);
        shading = bumped2 > 1e-12F ? bumped * (1.0F / std::sqrt(bumped2)) : shading;
      }
    }
    if constexpr (kFeatures.emission) {
      if (material.emit.texture != nullptr && shines) {
        const Vec2f at = coordinates.at<kFeatures>(material.emit);
        const Vec4f c =
            read_texture(*material.emit.texture, at.x, at.y, coordinates.lod + material.emit.half_log2_texels);
        hit.emission *= Vec3f{c.x, c.y, c.z};
      }
    }
  }
  hit.shading = bend_normal(shading * side, hit.geometric, -direction);
}

}  // namespace gazetrace
