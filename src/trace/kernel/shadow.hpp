// SPDX-License-Identifier: Apache-2.0
// Shadow rays are collected over the whole batch and then traced together.
#pragma once

#include "trace/kernel/path_kernel.hpp"

namespace gazetrace {

template <bool kLayers>
inline void PathKernel<kLayers>::queue_shadow(int vertex, std::size_t slot, std::size_t i, const LightSample& light,
                                              const Vec3f& arriving) {
  const ChunkHits& chunk = work_.chunk;
  ShadowBatch& shadows = work_.shadows;
  const std::size_t n = shadow_count_++;
  // Ends before the light by as much as rounding may move either end, so that an emitter does not shadow itself.
  const float tfar = light.distance - light.slack - 2 * chunk.offset[i];
  set_ray(shadows.rays, n, leaving_point(i, light.direction), light.direction, 0.0F, tfar);
  shadows.rays.alpha_key[n] = alpha_key(slot, 2U * static_cast<std::uint32_t>(vertex) + 1U);
  shadows.slot[n] = static_cast<std::uint32_t>(slot);
  shadows.r[n] = arriving.x;
  shadows.g[n] = arriving.y;
  shadows.b[n] = arriving.z;
  if (frame_.settings.light_groups) {
    shadows.diffuse.set(n, vertex == 0 ? chunk.light_diffuse.get(i) : work_.groups.diffuse.get(slot));
  }
}

template <bool kLayers>
inline void PathKernel<kLayers>::trace_shadows(int vertex) {
  const int count = static_cast<int>(shadow_count_);
  ShadowBatch& shadows = work_.shadows;
  stamp(shadows.rays, shadows.slot, shadow_count_);
  const RayShape shape = vertex == 0 && !frame_.single_rays ? RayShape::packet : RayShape::single;
  counts_.rays_shadow += shadow_count_;
  record(shadows.rays, count, shape, true);
  counts_.rejected +=
      static_cast<std::uint64_t>(frame_.scene->rays->occluded(shadows.rays, count, shape, work_.occluded.data));
  for (std::size_t n = 0; n < shadow_count_; ++n) {
    if (work_.occluded[n] == 0) {
      const Vec3f arriving{shadows.r[n], shadows.g[n], shadows.b[n]};
      const std::size_t slot = shadows.slot[n];
      work_.radiance.r[slot] += arriving.x;
      work_.radiance.g[slot] += arriving.y;
      work_.radiance.b[slot] += arriving.z;
      if (frame_.settings.light_groups) {
        add_to_groups(slot, arriving, vertex + 1, LightGroup::emission, shadows.diffuse.get(n));
      }
    } else if (work_.occluded[n] == 2) {
      work_.radiance.rejected[shadows.slot[n]] = 1;
    }
  }
}

}  // namespace gazetrace
