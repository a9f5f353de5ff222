// SPDX-License-Identifier: Apache-2.0
// Counts, pixel by pixel, which surfaces a few dozen first hits find. Rays are made as those of samples are: spread by
// the pixel filter, through the lens, at the times of an open shutter, and through what is transparent by chance.
#include "trace/guides/coverage.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "trace/guides/hit_identity.hpp"
#include "trace/guides/primary_rays.hpp"
#include "trace/samples/pixel_filter.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kCoverageSeed = 0x636f766572616765ULL;  // keeps these random numbers apart from the samples'
constexpr int kMostRays = kBatchSize;
constexpr int kMostRanks = 16;

void check(const Scene& scene, const std::vector<SurfaceIds>& surfaces, const CoverageSettings& settings) {
  if (settings.rays < 1 || settings.rays > kMostRays) {
    throw Error(ErrorKind::usage, "coverage", std::to_string(settings.rays) + " rays in a pixel",
                "ask for 1 to " + std::to_string(kMostRays));
  }
  if (settings.ranks < 1 || settings.ranks > kMostRanks) {
    throw Error(ErrorKind::usage, "coverage", std::to_string(settings.ranks) + " ranks",
                "ask for 1 to " + std::to_string(kMostRanks));
  }
  for (const SurfaceIds& one : surfaces) {
    if (one.ids.size() != (one.by_material ? scene.materials.size() : scene.instances.size())) {
      throw Error(ErrorKind::runtime, "coverage", "there is not one identifier for each object or material",
                  "make them of the scene that is traced");
    }
  }
}

// The identifiers of one pixel, with the number of rays that hit each.
class PixelCounts {
 public:
  void add(std::uint32_t id) {
    if (id == 0) {
      return;
    }
    for (auto& [known, count] : counts_) {
      if (known == id) {
        ++count;
        return;
      }
    }
    counts_.emplace_back(id, 1);
  }
  void store(std::size_t pixel, int rays, Coverage& out) {
    std::sort(counts_.begin(), counts_.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second > b.second : a.first < b.first;
    });
    const std::size_t ranks = std::min(counts_.size(), out.id.size());
    for (std::size_t rank = 0; rank < ranks; ++rank) {
      out.id[rank].pixels[pixel] = std::bit_cast<float>(counts_[rank].first);
      out.share[rank].pixels[pixel] = static_cast<float>(counts_[rank].second) / static_cast<float>(rays);
    }
    counts_.clear();
  }

 private:
  std::vector<std::pair<std::uint32_t, int>> counts_;
};

class CoverageTracer {
 public:
  CoverageTracer(const Scene& scene, const RenderScene& render_scene, const CameraRays& camera, std::int32_t frame,
                 int width_px, int height_px, const std::vector<SurfaceIds>& surfaces, const CoverageSettings& settings)
      : scene_(scene),
        render_scene_(render_scene),
        camera_(camera),
        surfaces_(surfaces),
        settings_(settings),
        filter_(settings.filter, settings.footprint),
        frame_(frame),
        width_px_(width_px),
        height_px_(height_px) {}

  // Pixels [x0, x1) of a row, whose rays are one batch.
  void trace_run(int y, int x0, int x1, FirstHitBatch& work, std::vector<PixelCounts>& counts,
                 std::vector<Coverage>& out) const {
    std::size_t count = 0;
    for (int x = x0; x < x1; ++x) {
      for (int i = 0; i < settings_.rays; ++i) {
        add_ray(x, y, static_cast<std::uint32_t>(i), count++, work.rays);
      }
    }
    render_scene_.rays->intersect(work.rays, static_cast<int>(count), RayShape::coherent_packet, work.hits);
    std::size_t k = 0;
    for (int x = x0; x < x1; ++x) {
      for (int i = 0; i < settings_.rays; ++i) {
        const HitIdentity hit = identity_of_hit(scene_, render_scene_, work.hits, k++);
        if (hit.object == 0) {
          continue;
        }
        for (std::size_t s = 0; s < surfaces_.size(); ++s) {
          const SurfaceIds& ids = surfaces_[s];
          counts[s].add(ids.ids[(ids.by_material ? hit.material : hit.object) - 1]);
        }
      }
      for (std::size_t s = 0; s < surfaces_.size(); ++s) {
        counts[s].store(out[s].id.front().index(x, y), settings_.rays, out[s]);
      }
    }
  }

 private:
  void add_ray(int x, int y, std::uint32_t i, std::size_t k, RayBatch& rays) const {
    const SampleKey key = make_sample_key(hash_combine(settings_.seed, kCoverageSeed), frame_,
                                          static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x));
    const Vec2f inside = sample_2d(key, i, dimension_of(PathDimension::pixel));
    const Vec2f offset = filter_.offset(inside.x, inside.y);
    const float px = (static_cast<float>(x) - 0.5F * static_cast<float>(width_px_)) + (0.5F + offset.x);
    const float py = (static_cast<float>(y) - 0.5F * static_cast<float>(height_px_)) + (0.5F + offset.y);
    const float time = sample_1d(key, i, dimension_of(PathDimension::time));
    const auto alpha_key = hash32(static_cast<std::uint32_t>(key.value >> 32U) ^ hash32(i));
    if (camera_.has_lens() || camera_.moves()) {
      const Vec2f lens = concentric_disk(sample_2d(key, i, dimension_of(PathDimension::lens)));
      put_camera_ray(camera_.ray(px, py, lens, time), alpha_key, k, rays);
    } else {
      put_camera_ray(camera_.ray(px, py), alpha_key, k, rays);
    }
    if (render_scene_.blurs) {
      rays.time[k] = time;
    }
  }

  const Scene& scene_;
  const RenderScene& render_scene_;
  const CameraRays& camera_;
  const std::vector<SurfaceIds>& surfaces_;
  const CoverageSettings& settings_;
  PixelFilterSampler filter_;
  std::int32_t frame_;
  int width_px_, height_px_;
};

}  // namespace

std::vector<Coverage> trace_coverage(const Scene& scene, const RenderScene& render_scene, const CameraRays& camera,
                                     std::int32_t frame, int width_px, int height_px,
                                     const std::vector<SurfaceIds>& surfaces, const CoverageSettings& settings,
                                     int threads) {
  check(scene, surfaces, settings);
  std::vector<Coverage> out(surfaces.size());
  for (Coverage& one : out) {
    one.id.assign(static_cast<std::size_t>(settings.ranks), ImageGray(width_px, height_px));
    one.share = one.id;
  }
  const CoverageTracer tracer(scene, render_scene, camera, frame, width_px, height_px, surfaces, settings);
  const int run_px = kBatchSize / settings.rays;
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    const FlushDenormals flush;
    const auto work = std::make_unique<FirstHitBatch>();
    std::vector<PixelCounts> counts(surfaces.size());
    for (int x0 = 0; x0 < width_px; x0 += run_px) {
      tracer.trace_run(static_cast<int>(row), x0, std::min(x0 + run_px, width_px), *work, counts, out);
    }
  });
  return out;
}

}  // namespace gazetrace
