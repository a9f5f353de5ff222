// SPDX-License-Identifier: Apache-2.0
// The first stage, which makes a camera ray for every sample of the batch.
#pragma once

#include "trace/kernel/path_kernel.hpp"

namespace gazetrace {

template <bool kLayers>
inline void PathKernel<kLayers>::start(int count) {
  RayBatch& rays = work_.rays[0];
  PathBatch& paths = work_.paths[0];
  const CameraRays& camera = *frame_.camera;
  const auto begin_path = [&](std::size_t i, const CameraRays::Ray& ray) __attribute__((always_inline)) {
    set_ray(rays, i, ray.origin, ray.direction, ray.tnear, ray.tfar);
    rays.alpha_key[i] = alpha_key(i, 0);
    paths.slot[i] = static_cast<std::uint32_t>(i);
    paths.r[i] = 1;
    paths.g[i] = 1;
    paths.b[i] = 1;
    paths.pdf[i] = 0;
    work_.radiance.r[i] = 0;
    work_.radiance.g[i] = 0;
    work_.radiance.b[i] = 0;
    work_.radiance.rejected[i] = 0;
  };
  if (camera.has_lens() || camera.moves()) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const SampleKey key = work_.samples.key[i];
      const std::uint32_t index = work_.samples.index[i];
      const Vec2f lens = concentric_disk(sample_2d(key, index, dimension_of(PathDimension::lens)));
      begin_path(i, camera.ray(work_.samples.x[i], work_.samples.y[i], lens, time_of(i)));
    }
  } else {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      begin_path(i, camera.ray(work_.samples.x[i], work_.samples.y[i]));
    }
  }
  if (has_layers()) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      paths.body[i] = kNoId;
    }
  }
  if (frame_.settings.light_groups) {
    for (BatchVec3& radiance : work_.groups.radiance) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        radiance.set(i, {});
      }
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      work_.groups.diffuse.set(i, {});
    }
  }
  if (frame_.settings.guides) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      work_.guides.hit[i] = 0;
    }
  }
  if (frame_.settings.surfaces) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      work_.surfaces.kind[i] = SurfaceKind::miss;
      work_.surfaces.blended[i] = 0;
    }
  }
}

}  // namespace gazetrace
