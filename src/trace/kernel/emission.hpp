// SPDX-License-Identifier: Apache-2.0
// Light from surfaces: emission that a ray finds, and the textures of light samples.
#pragma once

#include <vector>

#include "material/lobes/clearcoat.hpp"
#include "trace/guides/first_hit.hpp"
#include "trace/kernel/layered_hit.hpp"
#include "trace/kernel/path_kernel.hpp"
#include "trace/kernel/surface_hit.hpp"

namespace gazetrace {

template <bool kLayers>
inline void PathKernel<kLayers>::add_emission(int vertex, std::size_t i, std::size_t slot, const Vec3f& throughput,
                                              const ShadingMaterial& material, float pdf_bsdf) {
  const ChunkHits& chunk = work_.chunk;
  const Vec3f emission = emitted_radiance(*frame_.scene, chunk, i, material, has_layers());
  float weight = 1;
  if (vertex > 0) {
    float pdf_light = 0;
    const std::uint32_t emitter = emitter_of(i);
    if (emitter != kNoEmitter) {
      // The geometric normal is turned towards the ray; the sampler needs the sign relative to the front face.
      const float cosine = -dot(chunk.geometric.get(i), chunk.direction.get(i)) * chunk.side[i];
      const auto batch = static_cast<std::size_t>(vertex & 1);
      const PathBatch& paths = work_.paths[batch];
      const std::size_t k = chunk.path[i];
      pdf_light = frame_.lights->pdf_triangle(emitter, cosine, chunk.t[i] * chunk.t[i], paths.lit_point.get(k),
                                              paths.lit_normal.get(k));
    }
    weight = weight_of_found_light(vertex, pdf_bsdf, pdf_light);
  }
  add(slot, clamped(vertex, throughput * emission * weight), vertex);
}

template <bool kLayers>
inline std::uint32_t PathKernel<kLayers>::emitter_of(std::size_t i) const {
  const RenderScene& scene = *frame_.scene;
  const std::size_t k = work_.chunk.path[i];
  std::uint32_t record = work_.hits.geometry[k];
  std::uint32_t scene_instance = kNoId;
  if (work_.chunk.instance[i] != kNoId) {
    const ShadingInstance& instance = scene.instances[work_.chunk.instance[i]];
    record += instance.first_geometry;
    scene_instance = instance.scene_instance;
  }
  const GeometryRecord& geometry = scene.geometries[record];
  scene_instance = scene_instance == kNoId ? geometry.scene_instance : scene_instance;
  return frame_.lights->emitter_of(scene_instance, geometry.scene_geometry, work_.hits.primitive[k]);
}

// A light sample on a textured emitter has its position instead of the texture's value, which is read here. Emission of
// alpha-masked or blended emitters is weighted by their coverage, since rays that look for them pass the rest.
template <bool kLayers>
inline Vec3f PathKernel<kLayers>::light_radiance(const LightSample& light) const {
  if (light.emitter != kNoEmitter) {
    const EmissiveTriangle& emitter = frame_.lights->triangle(light.emitter);
    const ShadingMaterial& material = frame_.scene->materials[static_cast<std::size_t>(emitter.material)];
    Vec3f radiance = light.radiance;
    if (material.emit.texture != nullptr) {
      const Vec2f at = place_on_emitter(emitter, material.emit, light.barycentric);
      const Vec4f c = read_texture(*material.emit.texture, at.x, at.y, 0.0F);
      radiance *= Vec3f{c.x, c.y, c.z};
    }
    if (has_layers()) {
      const LayeredMaterial* layers = frame_.scene->layered.of(static_cast<std::uint32_t>(emitter.material));
      if (layers != nullptr && layers->layers.clearcoat) {
        float coat = layers->source->clearcoat.factor;
        if (layers->clearcoat.texture != nullptr) {
          const Vec2f at = place_on_emitter(emitter, layers->clearcoat, light.barycentric);
          coat *= read_texture(*layers->clearcoat.texture, at.x, at.y, 0.0F).x;
        }
        radiance *= passes_coat(coat, dot(emitter.normal, light.direction));
      }
    }
    if (material.alpha_mode != AlphaMode::opaque) {
      radiance = radiance * coverage_of_emitter(emitter, material, light.barycentric);
    }
    return radiance;
  }
  return light.radiance;
}

template <bool kLayers>
inline const Geometry& PathKernel<kLayers>::geometry_of(const EmissiveTriangle& emitter) const {
  const Instance& instance = frame_.source->instances[static_cast<std::size_t>(emitter.instance)];
  return frame_.source->meshes[static_cast<std::size_t>(instance.mesh)]
      .geometries[static_cast<std::size_t>(emitter.geometry)];
}

// The texture coordinates of a point on an emitter; (0, 0) where the triangle has none.
template <bool kLayers>
inline Vec2f PathKernel<kLayers>::place_on_emitter(const EmissiveTriangle& emitter, const ShadingTexture& texture,
                                                   const Vec2f& at) const {
  const Geometry& geometry = geometry_of(emitter);
  const auto& corner = geometry.triangles[static_cast<std::size_t>(emitter.primitive)];
  const std::vector<Vec2f>& set = texture.uv_set == 1 ? geometry.uv1 : geometry.uv0;
  Vec2f uv;
  if (set.size() == geometry.positions.size()) {
    const float w = 1.0F - at.x - at.y;
    uv = {w * set[corner[0]].x + at.x * set[corner[1]].x + at.y * set[corner[2]].x,
          w * set[corner[0]].y + at.x * set[corner[1]].y + at.y * set[corner[2]].y};
  }
  const auto& m = texture.transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

// The share of rays that RenderScene::transparent stops at this point.
template <bool kLayers>
inline float PathKernel<kLayers>::coverage_of_emitter(const EmissiveTriangle& emitter, const ShadingMaterial& material,
                                                      const Vec2f& at) const {
  const Geometry& geometry = geometry_of(emitter);
  float alpha = material.base_color.w;
  if (material.base.texture != nullptr) {
    const Vec2f place = place_on_emitter(emitter, material.base, at);
    alpha *= read_alpha(*material.base.texture, place.x, place.y);
  }
  if (!geometry.colors.empty()) {
    const auto& corner = geometry.triangles[static_cast<std::size_t>(emitter.primitive)];
    alpha *= (1.0F - at.x - at.y) * geometry.colors[corner[0]].w + at.x * geometry.colors[corner[1]].w +
             at.y * geometry.colors[corner[2]].w;
  }
  if (material.alpha_mode == AlphaMode::mask) {
    return alpha < material.alpha_cutoff ? 0.0F : 1.0F;
  }
  return std::clamp(alpha, 0.0F, 1.0F);
}

}  // namespace gazetrace
