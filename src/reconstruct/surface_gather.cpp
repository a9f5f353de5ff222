// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_gather.hpp"

#include <algorithm>
#include <cmath>

#include "core/instruction_sets.hpp"

namespace gazetrace {
namespace {

// As surface_likeness, on lanes; without branches, so that it becomes vectors.
template <std::size_t kWidth>
[[gnu::always_inline]] inline void add_to_lanes(const SurfaceCell& cell, const GatherLane& tent,
                                                const SurfaceLanes& pixels, const SmoothingSettings& settings,
                                                LightLanes& sums) {
  const Vec3f n = cell.normal;
  const Vec3f p = cell.place_m;
  const float slack = 0.5F * cell.footprint_m;
  const auto kind = static_cast<std::int32_t>(cell.kind);
  for (std::size_t i = 0; i < kWidth; ++i) {
    const Vec3f normal{pixels.normal_x[i], pixels.normal_y[i], pixels.normal_z[i]};
    const Vec3f way{p.x - pixels.place_x[i], p.y - pixels.place_y[i], p.z - pixels.place_z[i]};
    const float facing = facing_power(dot(normal, n));
    const float off = std::max(std::fabs(dot(normal, way)), std::fabs(dot(n, way)));
    const float like = facing * falling(off / (settings.plane * std::sqrt(dot(way, way)) + slack));
    const bool counts = (static_cast<int>(like >= kLeastLikeness) & static_cast<int>(pixels.kind[i] == kind)) != 0;
    const float nearness = tent[i] * cell.samples;
    const float w = counts ? nearness * like : 0.0F;
    sums.all[i] += nearness;
    sums.weight[i] += w;
    sums.variance[i] += w * w * cell.variance;
    sums.reflected_r[i] += w * cell.reflected.x;
    sums.reflected_g[i] += w * cell.reflected.y;
    sums.reflected_b[i] += w * cell.reflected.z;
    sums.albedo_r[i] += w * cell.albedo.x;
    sums.albedo_g[i] += w * cell.albedo.y;
    sums.albedo_b[i] += w * cell.albedo.z;
  }
}

}  // namespace

GAZETRACE_CLONES void add_cell(const SurfaceCell& cell, std::size_t k, const SurfaceLanes& pixels,
                               const SmoothingSettings& settings, LightLanes& sums) {
  if (pixels.count > 4) {
    add_to_lanes<kGatherLanes>(cell, pixels.tent[k], pixels, settings, sums);
  } else {
    add_to_lanes<4>(cell, pixels.tent[k], pixels, settings, sums);
  }
}

}  // namespace gazetrace
