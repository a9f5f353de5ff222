// SPDX-License-Identifier: Apache-2.0
// Which instance of the scene a ray hit, and which of its materials.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gazetrace/scene.hpp"
#include "trace/rays/ray_batch.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

struct HitIdentity {
  std::uint32_t object = 0;    // 1 + index into Scene::instances; 0: nothing was hit
  std::uint32_t material = 0;  // 1 + index into Scene::materials; 0: nothing
};

inline HitIdentity identity_of_hit(const Scene& scene, const RenderScene& render_scene, const HitBatch& hits,
                                   std::size_t k) {
  std::uint32_t record = hits.geometry[k];
  if (record == kNoId || record == kRejected) {
    return {};
  }
  std::uint32_t scene_instance = kNoId;
  if (hits.instance[k] != kNoId) {
    const ShadingInstance& instance = render_scene.instances[hits.instance[k] - render_scene.first_instance_id];
    record += instance.first_geometry;
    scene_instance = instance.scene_instance;
  }
  const GeometryRecord& geometry = render_scene.geometries[record];
  scene_instance = scene_instance == kNoId ? geometry.scene_instance : scene_instance;
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[scene_instance].mesh)];
  return {1 + scene_instance, 1 + static_cast<std::uint32_t>(mesh.geometries[geometry.scene_geometry].material)};
}

}  // namespace gazetrace
