// SPDX-License-Identifier: Apache-2.0
#include "trace/guides/guides.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "trace/guides/guide_edges.hpp"
#include "trace/guides/guide_rays.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {
namespace {

constexpr int kTilePx = 32;
static_assert(kTilePx * kTilePx == kBatchSize);
constexpr int kMostRays = 64;

// Traces the rays that were added, and stores what they see in work.found at their places.
void trace_rays(const GuideFrame& frame, GuideWorkspace& work) {
  const std::size_t count = std::exchange(work.count, 0);
  intersect_rays(frame, count, work);
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    std::size_t hit_count = 0;
    for (std::size_t k = begin; k < std::min(begin + kChunk, count); ++k) {
      if (is_hit(work.hits, k)) {
        locate_hit(frame.scene, work.hits, k, work.chunk, hit_count++);
      } else {
        work.found[work.place[k]] = first_miss(frame, work, k);
      }
    }
    if (hit_count > 0) {
      place_first_hits(frame, hit_count, work);
      shade_first_hits(frame, hit_count, work);
    }
  }
}

// Traces ray `sample` of every pixel of the tile whose corner is (x0, y0).
void trace_tile(const GuideFrame& frame, int x0, int y0, std::uint32_t sample, GuideWorkspace& work) {
  const auto spp = static_cast<std::size_t>(frame.settings.spp);
  for (std::uint32_t i = 0; i < kBatchSize; ++i) {
    const PixelIndex at = place_on_curve(i);
    const int x = x0 + at.x;
    const int y = y0 + at.y;
    if (x >= frame.width_px || y >= frame.height_px) {
      continue;
    }
    Vec2f inside{0.5F, 0.5F};
    if (spp > 1) {
      const SampleKey key{hash64(kGuideKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x)))};
      inside = sample_2d(key, sample, dimension_of(PathDimension::pixel));
    }
    add_ray(frame, from_center(frame, x, y, inside), x, y, sample,
            static_cast<std::size_t>(at.y * kTilePx + at.x) * spp + sample, work);
  }
  trace_rays(frame, work);
}

struct Identity {
  std::uint32_t object, material;
  SurfaceKind kind;
  friend bool operator==(const Identity&, const Identity&) = default;
};

Identity most_frequent(const FirstHit* hits, std::size_t spp) {
  Identity best{};
  std::size_t most = 0;
  for (std::size_t a = 0; a < spp && most <= spp - a; ++a) {
    const Identity identity{hits[a].object, hits[a].material, hits[a].kind};
    std::size_t times = 0;
    for (std::size_t b = a; b < spp; ++b) {
      times += identity == Identity{hits[b].object, hits[b].material, hits[b].kind} ? 1U : 0U;
    }
    if (times > most) {
      most = times;
      best = identity;
    }
  }
  return best;
}

// Stores the only ray of a pixel, which goes through the centre.
void store_only(const FirstHit& hit, std::size_t pixel, Guides& out, RoughNormal& smooth) {
  out.albedo.pixels[pixel] = hit.albedo;
  out.normal.pixels[pixel] = hit.normal;
  out.emission.pixels[pixel] = hit.emission;
  out.depth_m.pixels[pixel] = hit.depth_m;
  out.object.pixels[pixel] = hit.object;
  out.material.pixels[pixel] = hit.material;
  out.kind.pixels[pixel] = hit.kind;
  smooth = hit.smooth;
}

void store_mean(const FirstHit* hits, std::size_t spp, std::size_t pixel, Guides& out, RoughNormal& smooth) {
  Vec3f albedo;
  Vec3f normal;
  Vec3f emission;
  float depth = 0;
  int surfaces = 0;
  for (std::size_t s = 0; s < spp; ++s) {
    albedo += hits[s].albedo;
    normal += hits[s].normal;
    emission += hits[s].emission;
    if (hits[s].kind != SurfaceKind::miss) {
      depth += hits[s].depth_m;
      ++surfaces;
    }
  }
  const auto n = static_cast<float>(spp);
  out.albedo.pixels[pixel] = albedo / n;
  out.normal.pixels[pixel] = normal / n;
  out.emission.pixels[pixel] = emission / n;
  if (surfaces > 0) {
    out.depth_m.pixels[pixel] = depth / static_cast<float>(surfaces);
  }
  const Identity identity = most_frequent(hits, spp);
  out.object.pixels[pixel] = identity.object;
  out.material.pixels[pixel] = identity.material;
  out.kind.pixels[pixel] = identity.kind;
  smooth = hits[0].smooth;
}

}  // namespace

void check_guides(const GuideSettings& settings) {
  if (settings.spp < 1 || settings.spp > kMostRays) {
    throw Error(ErrorKind::usage, "guides", std::to_string(settings.spp) + " rays a pixel",
                "ask for 1 to " + std::to_string(kMostRays));
  }
  if (settings.edge_rays < 0 || settings.edge_rays > kMostRays) {
    throw Error(ErrorKind::usage, "guides", std::to_string(settings.edge_rays) + " rays at edges",
                "ask for 0 to " + std::to_string(kMostRays));
  }
}

Guides trace_guides(const RenderScene& scene, const LightSampler& lights, const CameraRays& camera, int width_px,
                    int height_px, const GuideSettings& settings, int threads) {
  check_guides(settings);
  Guides out;
  out.spp = settings.spp;
  const CameraRays::Placement& placement = camera.placement();
  out.camera = {camera.is_perspective(), placement.forward, placement.right_step, placement.up_step,
                camera.middle_px()};
  out.albedo = ImageRgb(width_px, height_px);
  out.normal = ImageRgb(width_px, height_px);
  out.depth_m = ImageGray(width_px, height_px, std::numeric_limits<float>::infinity());
  out.emission = ImageRgb(width_px, height_px);
  out.object = Image<std::uint32_t>(width_px, height_px);
  out.material = Image<std::uint32_t>(width_px, height_px);
  out.kind = Image<SurfaceKind>(width_px, height_px);

  Image<RoughNormal> smooth(width_px, height_px);

  const GuideFrame frame{scene, lights, camera, settings, width_px, height_px};
  const auto spp = static_cast<std::size_t>(settings.spp);
  const int tiles_x = (width_px + kTilePx - 1) / kTilePx;
  const int tiles_y = (height_px + kTilePx - 1) / kTilePx;
  // A row of tiles is one task, so that its workspace is made once.
  parallel_for(static_cast<std::size_t>(tiles_y), threads, [&](std::size_t tile_y) {
    const FlushDenormals flush;
    const auto work = std::make_unique<GuideWorkspace>();
    work->found.resize(kBatchSize * spp);
    const int y0 = static_cast<int>(tile_y) * kTilePx;
    for (int x0 = 0; x0 < tiles_x * kTilePx; x0 += kTilePx) {
      for (std::uint32_t sample = 0; sample < spp; ++sample) {
        trace_tile(frame, x0, y0, sample, *work);
      }
      for (int y = y0; y < std::min(y0 + kTilePx, height_px); ++y) {
        for (int x = x0; x < std::min(x0 + kTilePx, width_px); ++x) {
          const auto place = static_cast<std::size_t>((y - y0) * kTilePx + (x - x0));
          const std::size_t pixel = out.albedo.index(x, y);
          if (spp == 1) {
            store_only(work->found[place], pixel, out, smooth.pixels[pixel]);
          } else {
            store_mean(&work->found[place * spp], spp, pixel, out, smooth.pixels[pixel]);
          }
        }
      }
    }
  });
  if (settings.edge_rays > 0) {
    trace_edges(frame, smooth, out, threads);
  }
  return out;
}

}  // namespace gazetrace
