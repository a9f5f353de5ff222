// SPDX-License-Identifier: Apache-2.0
// Divides the light of a sample by how it came to the camera. Nothing of it is done unless it is asked for, and the
// radiance itself does not depend on it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "material/layered_bsdf.hpp"
#include "trace/kernel/bsdf_lanes.hpp"
#include "trace/kernel/layered_hit.hpp"
#include "trace/kernel/path_kernel.hpp"
#include "trace/kernel/shading_frame.hpp"

namespace gazetrace {

template <bool kLayers>
void PathKernel<kLayers>::add_to_groups(std::size_t slot, const Vec3f& radiance, int events, LightGroup seen,
                                        const Vec3f& diffuse) {
  const auto add_part = [&](LightGroup group, const Vec3f& part) {
    BatchVec3& sum = work_.groups.radiance[static_cast<std::size_t>(group)];
    sum.set(slot, sum.get(slot) + part);
  };
  if (events == 0) {
    add_part(seen, radiance);
    return;
  }
  const Vec3f part = radiance * diffuse;
  add_part(events == 1 ? LightGroup::diffuse_direct : LightGroup::diffuse_indirect, part);
  add_part(events == 1 ? LightGroup::specular_direct : LightGroup::specular_indirect, radiance - part);
}

// For the hits of camera rays, after their BSDFs were evaluated and sampled.
template <bool kLayers>
void PathKernel<kLayers>::find_diffuse_shares(const std::uint16_t* active, std::size_t active_count,
                                              const LightSample* lights, bool bounces) {
  ChunkHits& chunk = work_.chunk;
  for (std::size_t a = 0; a < active_count; ++a) {
    const std::size_t i = active[a];
    if (lights != nullptr && lights[i].valid) {
      chunk.light_diffuse.set(i, diffuse_share(i, lights[i].direction));
    }
    if (bounces && chunk.next_good[i] != 0) {
      chunk.next_diffuse.set(i, diffuse_share(i, chunk.next.get(i)));
    }
  }
}

// Of the light that hit i sends from a direction to the camera, the share of the diffuse lobe in each channel. Where
// refraction depends on colour, that of the first channel's index.
template <bool kLayers>
inline Vec3f PathKernel<kLayers>::diffuse_share(std::size_t i, const Vec3f& world) const {
  const DiffuseModel diffuse = frame_.settings.diffuse;
  if (diffuse == DiffuseModel::matte) {
    return {1, 1, 1};
  }
  const ChunkHits& chunk = work_.chunk;
  const auto share = [](const Vec3f& part, const Vec3f& whole) {
    const auto of = [](float p, float w) { return w > 0 ? std::clamp(p / w, 0.0F, 1.0F) : 0.0F; };
    return Vec3f{of(part.x, whole.x), of(part.y, whole.y), of(part.z, whole.z)};
  };
  if (has_layers()) {
    const LayeredMaterial* material = frame_.scene->layered.of(chunk.material[i]);
    if (material != nullptr) {
      const LayeredHit hit = read_layered_hit(*frame_.scene, chunk, i, *material, 0);
      const LayeredBsdf bsdf(hit.surface, hit.frame.to_local(-chunk.direction.get(i)), diffuse);
      const Vec3f wi = hit.frame.to_local(world);
      return share(bsdf.diffuse_f_cos(wi), bsdf.evaluate(wi).f_cos);
    }
  }
  const LocalFrame local(chunk.shading.get(i));
  const BsdfParts parts = bsdf_parts(diffuse, {chunk.base_color.get(i), chunk.metallic[i], chunk.roughness[i]},
                                     local.to_local(-chunk.direction.get(i)), local.to_local(world));
  return share(parts.diffuse, parts.all);
}

}  // namespace gazetrace
