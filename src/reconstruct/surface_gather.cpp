// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_gather.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/instruction_sets.hpp"

namespace gazetrace {
namespace {

// Without branches, so that it becomes vectors.
template <std::size_t kWidth>
[[gnu::always_inline]] inline void add_to_lanes(const SurfaceCell& cell, const GatherLane& tent,
                                                const SurfaceLanes& pixels, const SmoothingSettings& settings,
                                                LightLanes& __restrict sums) {
  const Vec3f n = cell.normal;
  const Vec3f p = cell.position_m;
  const float slack = 0.5F * cell.footprint_m;
  const auto kind = static_cast<std::int32_t>(cell.kind);
  for (std::size_t i = 0; i < kWidth; ++i) {
    const Vec3f normal{pixels.normal_x[i], pixels.normal_y[i], pixels.normal_z[i]};
    const Vec3f way{p.x - pixels.place_x[i], p.y - pixels.place_y[i], p.z - pixels.place_z[i]};
    const float like = likeness(normal, n, way, slack, settings);
    const float nearness = tent[i] * cell.samples;
    const float w = pixels.kind[i] == kind ? nearness * like : 0.0F;
    sums.all[i] += nearness;
    sums.weight[i] += w;
    sums.variance[i] += w * w * cell.variance;
    sums.replica[i] += w * cell.replica;
    sums.error[i] += w * cell.variance;
    sums.reflected_r[i] += w * cell.reflected.x;
    sums.reflected_g[i] += w * cell.reflected.y;
    sums.reflected_b[i] += w * cell.reflected.z;
    sums.albedo_r[i] += w * cell.albedo.x;
    sums.albedo_g[i] += w * cell.albedo.y;
    sums.albedo_b[i] += w * cell.albedo.z;
  }
}

}  // namespace

GAZETRACE_CLONES void locate_lanes(const GuideCamera& camera, float x_px, float y_px, float block_px,
                                   SurfaceLanes& pixels) {
  const float scale = 1.0F / block_px;
  for (std::size_t i = 0; i < kGatherLanes; ++i) {
    const float x = pixels.x_px[i];
    const float y = pixels.y_px[i];
    const float depth = pixels.depth_m[i];
    const Vec3f across = camera.right_step * (x + camera.middle_px.x) - camera.up_step * (y + camera.middle_px.y);
    const Vec3f ahead = camera.forward + across;
    const Vec3f level = camera.forward * depth + across;
    pixels.place_x[i] = camera.perspective ? ahead.x * depth : level.x;
    pixels.place_y[i] = camera.perspective ? ahead.y * depth : level.y;
    pixels.place_z[i] = camera.perspective ? ahead.z * depth : level.z;
    const float fx = (x - x_px) * scale;
    const float fy = (y - y_px) * scale;
    pixels.tent[0][i] = (1.0F - fx) * (1.0F - fy);
    pixels.tent[1][i] = fx * (1.0F - fy);
    pixels.tent[2][i] = (1.0F - fx) * fy;
    pixels.tent[3][i] = fx * fy;
  }
}

GAZETRACE_CLONES void divide_light(LightLanes& sums) {
  for (std::size_t i = 0; i < kGatherLanes; ++i) {
    const float least = std::max(kLeastAlbedo * sums.weight[i], std::numeric_limits<float>::min());
    sums.reflected_r[i] /= std::max(sums.albedo_r[i], least);
    sums.reflected_g[i] /= std::max(sums.albedo_g[i], least);
    sums.reflected_b[i] /= std::max(sums.albedo_b[i], least);
    const float weight = std::max(sums.weight[i], std::numeric_limits<float>::min());
    sums.variance[i] = sums.variance[i] / weight / weight;
    sums.replica[i] /= weight;
    sums.error[i] /= weight;
  }
}

GAZETRACE_CLONES void add_cell(const SurfaceCell& cell, std::size_t k, const SurfaceLanes& pixels,
                               const SmoothingSettings& settings, LightLanes& sums) {
  if (pixels.count > 4) {
    add_to_lanes<kGatherLanes>(cell, pixels.tent[k], pixels, settings, sums);
  } else {
    add_to_lanes<4>(cell, pixels.tent[k], pixels, settings, sums);
  }
}

}  // namespace gazetrace
