// SPDX-License-Identifier: Apache-2.0
// What is known of a hit before any light is gathered: its emission, its albedo, its kind and its instance. Used by the
// path tracer and by the pass that traces first hits only.
#pragma once

#include <algorithm>

#include "gazetrace/guides.hpp"
#include "material/directional_albedo.hpp"
#include "material/lobes/clearcoat.hpp"
#include "trace/kernel/layered_hit.hpp"
#include "trace/kernel/surface_hit.hpp"

namespace gazetrace {

inline constexpr float kGlossyRoughness = 0.35F;
inline constexpr float kGlossyMetalness = 0.5F;

// The radiance of an emissive material towards the ray, which must be on a side that emits; through its coat only where
// the model `has_layers`.
inline Vec3f emitted_radiance(const RenderScene& scene, const ChunkHits& chunk, std::size_t i,
                              const ShadingMaterial& material, bool has_layers) {
  Vec3f emission = material.emission;
  if (material.emit.texture != nullptr) {
    const Vec2f at = coordinates_at(scene, chunk, i, material.emit);
    const Vec4f c = read_texture(*material.emit.texture, at.x, at.y, level_at(scene, chunk, i, material.emit));
    emission *= Vec3f{c.x, c.y, c.z};
  }
  if (has_layers) {
    const LayeredMaterial* layers = scene.layered.of(chunk.material[i]);
    if (layers != nullptr && layers->layers.clearcoat) {
      const float coat = layers->source->clearcoat.factor * read_layer(scene, chunk, i, layers->clearcoat).x;
      emission *= passes_coat(coat, dot(chunk.geometric.get(i), chunk.direction.get(i)));
    }
  }
  return emission;
}

// Guides::albedo. Call it after finish_normals.
inline Vec3f albedo_to_divide_by(const RenderScene& scene, const ChunkHits& chunk, std::size_t i, DiffuseModel model) {
  const Vec3f base = chunk.base_color.get(i);
  if (scene.materials[chunk.material[i]].unlit) {
    return {1, 1, 1};
  }
  const LayeredMaterial* layers = scene.layered.of(chunk.material[i]);
  const float cosine = std::clamp(-dot(chunk.shading.get(i), chunk.direction.get(i)), 0.0F, 1.0F);
  const Vec3f albedo = model == DiffuseModel::matte
                           ? base
                           : directional_albedo({base, chunk.metallic[i], chunk.roughness[i]},
                                                layers != nullptr ? layers->f0 : kDielectricF0, cosine);
  return {std::max(albedo.x, kLeastAlbedo), std::max(albedo.y, kLeastAlbedo), std::max(albedo.z, kLeastAlbedo)};
}

inline SurfaceKind kind_of_hit(const RenderScene& scene, const ChunkHits& chunk, std::size_t i, DiffuseModel model) {
  if (scene.materials[chunk.material[i]].unlit) {
    return SurfaceKind::unlit;
  }
  if (model == DiffuseModel::matte) {
    return SurfaceKind::diffuse;
  }
  const LayeredMaterial* layers = scene.layered.of(chunk.material[i]);
  const bool glossy = chunk.metallic[i] > kGlossyMetalness || chunk.roughness[i] < kGlossyRoughness ||
                      (layers != nullptr && (layers->layers.clearcoat || layers->layers.transmission));
  return glossy ? SurfaceKind::glossy : SurfaceKind::diffuse;
}

// The index into Scene::instances of hit k of the packed batch, which is in lane i.
inline std::uint32_t scene_instance_of(const RenderScene& scene, const HitBatch& hits, std::size_t k,
                                       const ChunkHits& chunk, std::size_t i) {
  std::uint32_t record = hits.geometry[k];
  if (chunk.instance[i] != kNoId) {
    const ShadingInstance& instance = scene.instances[chunk.instance[i]];
    if (instance.scene_instance != kNoId) {
      return instance.scene_instance;
    }
    record += instance.first_geometry;
  }
  return scene.geometries[record].scene_instance;
}

}  // namespace gazetrace
