// SPDX-License-Identifier: Apache-2.0
// Rays that leave the scene, to which the environment contributes.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "material/lobes/volume.hpp"
#include "trace/kernel/path_kernel.hpp"

namespace gazetrace {

// The weight of light that a BSDF-sampled ray found, and that light sampling could have found, too.
template <bool kLayers>
inline float PathKernel<kLayers>::weight_of_found_light(int vertex, float pdf_bsdf, float pdf_light) const {
  if (vertex == 0) {
    return 1.0F;
  }
  switch (frame_.settings.light_sampling) {
    case LightSampling::light_only:
      return pdf_light > 0 ? 0.0F : 1.0F;  // rays count only what light samples cannot find
    case LightSampling::bsdf_only:
      return 1.0F;
    case LightSampling::mis:
      break;
  }
  return power_heuristic(pdf_bsdf, pdf_light);
}

// Adds the environment's radiance for the rays in `list`, which left the scene.
template <bool kLayers>
inline void PathKernel<kLayers>::add_sky(int vertex, const RayBatch& rays, const PathBatch& paths,
                                         const std::uint16_t* list, std::size_t count) {
  if (vertex == 0 && !frame_.settings.show_environment) {
    return;
  }
  std::array<Vec3f, kChunk> directions;
  std::array<LightSampler::EnvironmentHit, kChunk> sky;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = list[i];
    directions[i] = {rays.dx[k], rays.dy[k], rays.dz[k]};
  }
  frame_.lights->environment_many(directions.data(), count, sky.data());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = list[i];
    Vec3f throughput{paths.r[k], paths.g[k], paths.b[k]};
    if (has_layers()) {
      if (paths.body[k] != kNoId) {  // left a body through a hole in it
        throughput *= transmittance(frame_.scene->layered.materials[paths.body[k]].absorption_per_m,
                                    std::numeric_limits<float>::infinity());
      }
    }
    const float weight = weight_of_found_light(vertex, paths.pdf[k], sky[i].pdf);
    add(paths.slot[k], clamped(vertex, throughput * sky[i].radiance * weight), vertex, LightGroup::background);
  }
}

// For the rays after the last scattering event, where they can find the sky only: visibility is enough.
template <bool kLayers>
inline void PathKernel<kLayers>::see_sky(int vertex, int count) {
  const RayBatch& rays = work_.rays[static_cast<std::size_t>(vertex & 1)];
  const PathBatch& paths = work_.paths[static_cast<std::size_t>(vertex & 1)];
  record(rays, count, RayShape::single, true);
  counts_.rejected +=
      static_cast<std::uint64_t>(frame_.scene->rays->occluded(rays, count, RayShape::single, work_.occluded.data));
  std::array<std::uint16_t, kChunk> sky;
  for (std::size_t begin = 0; begin < static_cast<std::size_t>(count); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, static_cast<std::size_t>(count));
    std::size_t sky_count = 0;
    for (std::size_t k = begin; k < end; ++k) {
      sky[sky_count] = static_cast<std::uint16_t>(k);
      sky_count += work_.occluded[k] == 0 ? 1 : 0;
      if (work_.occluded[k] == 2) {
        work_.radiance.rejected[paths.slot[k]] = 1;
      }
    }
    add_sky(vertex, rays, paths, sky.data(), sky_count);
  }
}

}  // namespace gazetrace
