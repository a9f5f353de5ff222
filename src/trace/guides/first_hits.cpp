// SPDX-License-Identifier: Apache-2.0
// What single rays see: which object of which material, how far away and where. Nothing is shaded.
#include "trace/guides/first_hits.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "trace/guides/hit_identity.hpp"
#include "trace/guides/primary_rays.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kFirstHitKey = 0x666972737421ULL;  // keeps alpha hashes apart from those of traced samples

RayHit hit_of(const Scene& scene, const RenderScene& render_scene, const FirstHitBatch& work, std::size_t k) {
  const HitBatch& hits = work.hits;
  const HitIdentity identity = identity_of_hit(scene, render_scene, hits, k);
  RayHit hit;
  if (identity.object == 0) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    hit.distance_m = std::numeric_limits<double>::infinity();
    hit.position_m = {nan, nan, nan};
    return hit;
  }
  hit.object = identity.object;
  hit.material = identity.material;
  hit.distance_m = static_cast<double>(hits.t[k]);
  const Vec3d origin{work.rays.ox[k], work.rays.oy[k], work.rays.oz[k]};
  const Vec3d direction{work.rays.dx[k], work.rays.dy[k], work.rays.dz[k]};
  hit.position_m = render_scene.origin_m + origin + direction * hit.distance_m;
  return hit;
}

}  // namespace

std::vector<RayHit> trace_first_hits(const Scene& scene, const RenderScene& render_scene, const CameraRays& camera,
                                     int width_px, int height_px, const std::vector<Vec2d>& places_px, int threads) {
  std::vector<RayHit> hits(places_px.size());
  const std::size_t batches = (places_px.size() + kBatchSize - 1) / kBatchSize;
  parallel_for(batches, threads, [&](std::size_t batch) {
    const FlushDenormals flush;
    const auto work = std::make_unique<FirstHitBatch>();
    const std::size_t begin = batch * kBatchSize;
    const std::size_t end = std::min(begin + kBatchSize, places_px.size());
    for (std::size_t i = begin; i < end; ++i) {
      const auto x = static_cast<float>(places_px[i].x - 0.5 * width_px);
      const auto y = static_cast<float>(places_px[i].y - 0.5 * height_px);
      put_camera_ray(camera.ray(x, y), static_cast<std::uint32_t>(hash64(kFirstHitKey ^ i)), i - begin, work->rays);
    }
    // The places may be anywhere in any order, so the packet is not called coherent.
    render_scene.rays->intersect(work->rays, static_cast<int>(end - begin), RayShape::packet, work->hits);
    for (std::size_t i = begin; i < end; ++i) {
      hits[i] = hit_of(scene, render_scene, *work, i - begin);
    }
  });
  return hits;
}

}  // namespace gazetrace
