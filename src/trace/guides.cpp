// SPDX-License-Identifier: Apache-2.0
#include "trace/guides.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "trace/first_hit.hpp"
#include "trace/primary_rays.hpp"
#include "trace/sampler.hpp"

namespace gazetrace {
namespace {

constexpr int kTilePx = 32;
static_assert(kTilePx * kTilePx == kBatchSize);
constexpr int kMostRays = 64;
constexpr float kEdgeNormal = 0.906F;  // cosine of 25 degrees
constexpr float kEdgeDepth = 0.02F;
constexpr std::uint64_t kPlaceKey = 0x67756964657321ULL;  // keeps alpha hashes apart from those of traced samples

struct FirstHit {
  Vec3f albedo{1, 1, 1};
  Vec3f normal;
  Vec3f emission;
  float depth_m = std::numeric_limits<float>::infinity();
  std::uint32_t object = 0, material = 0;
  SurfaceKind kind = SurfaceKind::miss;
};

struct GuideWorkspace {
  RayBatch rays;
  HitBatch hits;
  ChunkHits chunk;
  std::size_t count = 0;            // of rays that are ready
  BatchArray<std::uint32_t> place;  // of each of them in `found`
  BatchArray<float> cone_spread;
  std::vector<FirstHit> found;  // of a tile: ray after ray of a pixel, pixel after pixel
};

struct GuideFrame {
  const RenderScene& scene;
  const LightSampler& lights;
  const CameraRays& camera;
  GuideSettings settings;
  int width_px, height_px;
};

Vec2f from_center(const GuideFrame& frame, int x, int y, const Vec2f& inside) {
  return {(static_cast<float>(x) - 0.5F * static_cast<float>(frame.width_px)) + inside.x,
          (static_cast<float>(y) - 0.5F * static_cast<float>(frame.height_px)) + inside.y};
}

template <KernelFeatures kFeatures, bool kLayers>
FirstHit first_hit(const GuideFrame& frame, const HitBatch& hits, const ChunkHits& chunk, std::size_t i) {
  const RenderScene& scene = frame.scene;
  const ShadingMaterial& material = scene.materials[chunk.material[i]];
  FirstHit hit;
  hit.albedo = albedo_to_divide_by(scene, chunk, i, frame.settings.diffuse);
  hit.normal = chunk.shading.get(i);
  hit.depth_m = chunk.t[i] * dot(chunk.direction.get(i), frame.camera.forward());
  hit.object = 1 + scene_instance_of<kFeatures>(scene, hits, chunk.path[i], chunk, i);
  hit.material = 1 + chunk.material[i];
  hit.kind = kind_of_hit(scene, chunk, i, frame.settings.diffuse);
  if (material.unlit) {
    hit.emission = chunk.base_color.get(i);
  } else if (material.emissive && (chunk.side[i] > 0 || material.double_sided)) {
    hit.emission = emitted_radiance<kFeatures, kLayers>(scene, chunk, i, material);
  }
  return hit;
}

// A ray through continuous pixel coordinates from the frame's centre, for pixel (x, y).
void add_ray(const GuideFrame& frame, const Vec2f& through, int x, int y, std::uint32_t sample, std::size_t place,
             GuideWorkspace& work) {
  const CameraRays::Ray ray = frame.camera.ray(through.x, through.y);
  const std::uint64_t key = hash64(kPlaceKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x)));
  const std::size_t k = work.count++;
  put_camera_ray(ray, hash32(static_cast<std::uint32_t>(key >> 32U) ^ hash32(sample)), k, work.rays);
  work.cone_spread[k] = ray.cone_spread * static_cast<float>(frame.settings.pixel_cone);
  work.place[k] = static_cast<std::uint32_t>(place);
}

// Traces the rays that were added, into work.found at their places.
template <KernelFeatures kFeatures, bool kLayers>
void trace_rays(const GuideFrame& frame, GuideWorkspace& work) {
  const std::size_t count = std::exchange(work.count, 0);
  const auto cone = static_cast<float>(frame.settings.pixel_cone);
  frame.scene.rays->intersect(work.rays, static_cast<int>(count), RayShape::coherent_packet, work.hits);

  ChunkHits& chunk = work.chunk;
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, count);
    std::size_t hit_count = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t geometry = work.hits.geometry[k];
      if (geometry != kNoId && geometry != kRejected) {
        locate_hit<kFeatures>(frame.scene, work.hits, k, chunk, hit_count++);
        continue;
      }
      FirstHit& miss = work.found[work.place[k]];
      miss = {};
      if (geometry == kNoId) {
        miss.emission = frame.lights.environment_radiance({work.rays.dx[k], work.rays.dy[k], work.rays.dz[k]});
      }
    }
    if (hit_count == 0) {
      continue;
    }
    for (std::size_t i = 0; i < hit_count; ++i) {
      const std::size_t k = chunk.path[i];
      chunk.direction.set(i, {work.rays.dx[k], work.rays.dy[k], work.rays.dz[k]});
      chunk.u[i] = work.hits.u[k];
      chunk.v[i] = work.hits.v[k];
      chunk.t[i] = work.hits.t[k];
      chunk.cone_width[i] = frame.camera.cone_width() * cone;
      chunk.cone_spread[i] = work.cone_spread[k];
    }
    gather_triangles<kFeatures>(frame.scene, work.rays.time, chunk, hit_count);
    place_hits<kFeatures>(chunk, hit_count);
    read_materials<kFeatures>(frame.scene, chunk, hit_count);
    if constexpr (kLayers) {
      chunk.smooth = chunk.shading;
    }
    finish_normals<kFeatures>(chunk, hit_count);
    for (std::size_t i = 0; i < hit_count; ++i) {
      work.found[work.place[chunk.path[i]]] = first_hit<kFeatures, kLayers>(frame, work.hits, chunk, i);
    }
  }
}

using TraceRays = void (*)(const GuideFrame&, GuideWorkspace&);

// Ray `sample` of every pixel of the tile whose corner is (x0, y0).
void trace_tile(const GuideFrame& frame, TraceRays trace, int x0, int y0, std::uint32_t sample, GuideWorkspace& work) {
  const auto spp = static_cast<std::size_t>(frame.settings.spp);
  for (std::uint32_t i = 0; i < kBatchSize; ++i) {
    const PixelIndex at = place_on_curve(i);
    const int x = x0 + at.x;
    const int y = y0 + at.y;
    if (x >= frame.width_px || y >= frame.height_px) {
      continue;
    }
    const SampleKey key{hash64(kPlaceKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x)))};
    const Vec2f inside = spp == 1 ? Vec2f{0.5F, 0.5F} : sample_2d(key, sample, dimension_of(PathDimension::pixel));
    add_ray(frame, from_center(frame, x, y, inside), x, y, sample,
            static_cast<std::size_t>(at.y * kTilePx + at.x) * spp + sample, work);
  }
  trace(frame, work);
}

// Whether (x, y) and a neighbour see different things.
bool parts(const Guides& guides, std::size_t a, std::size_t b) {
  return guides.object.pixels[a] != guides.object.pixels[b] || guides.material.pixels[a] != guides.material.pixels[b] ||
         guides.kind.pixels[a] != guides.kind.pixels[b] ||
         (guides.kind.pixels[a] != SurfaceKind::miss &&
          dot(guides.normal.pixels[a], guides.normal.pixels[b]) < kEdgeNormal);
}

// Depth (orthographic) or its inverse (perspective) is linear over a plane.
bool bends(const Guides& guides, std::size_t before, std::size_t at, std::size_t after) {
  const auto linear = [&](std::size_t i) {
    return guides.camera.perspective ? 1.0F / guides.depth_m.pixels[i] : guides.depth_m.pixels[i];
  };
  return std::fabs(linear(before) + linear(after) - 2 * linear(at)) > kEdgeDepth * std::fabs(linear(at));
}

bool may_be_crossed(const Guides& guides, int x, int y) {
  const int w = guides.kind.width_px;
  const int h = guides.kind.height_px;
  const std::size_t i = guides.kind.index(x, y);
  const auto stride = static_cast<std::size_t>(w);
  if ((x > 0 && parts(guides, i, i - 1)) || (x + 1 < w && parts(guides, i, i + 1)) ||
      (y > 0 && parts(guides, i, i - stride)) || (y + 1 < h && parts(guides, i, i + stride))) {
    return true;
  }
  if (guides.kind.pixels[i] == SurfaceKind::miss) {
    return false;
  }
  return (x > 0 && x + 1 < w && bends(guides, i - 1, i, i + 1)) ||
         (y > 0 && y + 1 < h && bends(guides, i - stride, i, i + stride));
}

// The more rays of the edges in rows [y0, y1).
std::vector<EdgeRay> trace_edges(const GuideFrame& frame, TraceRays trace, const Guides& guides, int y0, int y1,
                                 GuideWorkspace& work) {
  std::vector<EdgeRay> out;
  const auto flush = [&] {
    const std::size_t first = out.size() - work.count;
    trace(frame, work);
    for (std::size_t k = first; k < out.size(); ++k) {
      const FirstHit& hit = work.found[k - first];
      out[k].albedo = hit.albedo;
      out[k].normal = hit.normal;
      out[k].emission = hit.emission;
      out[k].depth_m = hit.depth_m;
      out[k].kind = hit.kind;
    }
  };
  const auto rays = static_cast<std::uint32_t>(frame.settings.edge_rays);
  for (int y = y0; y < y1; ++y) {
    for (int x = 0; x < frame.width_px; ++x) {
      if (!may_be_crossed(guides, x, y)) {
        continue;
      }
      for (std::uint32_t r = 0; r < rays; ++r) {
        // The same points in every pixel: a net without a scramble, so that edges are stepped evenly.
        const Vec2f inside = sample_2d(SampleKey{kPlaceKey}, r, dimension_of(PathDimension::pixel));
        const Vec2f through = from_center(frame, x, y, inside);
        EdgeRay& edge_ray = out.emplace_back();
        edge_ray.pixel = static_cast<std::uint32_t>(guides.kind.index(x, y));
        edge_ray.x = through.x;
        edge_ray.y = through.y;
        add_ray(frame, through, x, y, static_cast<std::uint32_t>(frame.settings.spp) + r, work.count, work);
        if (work.count == kBatchSize) {
          flush();
        }
      }
    }
  }
  flush();
  return out;
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

void store_pixel(const FirstHit* hits, std::size_t spp, std::size_t pixel, Guides& out) {
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
}

// The smallest variant that covers the scene.
TraceRays choose_variant(const RenderScene& scene, DiffuseModel diffuse) {
  constexpr KernelFeatures kTextured{.textures = true};
  constexpr KernelFeatures kInstanced{.textures = true, .instances = true, .extras = true};
  if (scene.features.layers.any() && diffuse != DiffuseModel::matte) {
    return trace_rays<kInstanced, true>;
  }
  return scene.instances.empty() && scene.extras.empty() ? trace_rays<kTextured, false> : trace_rays<kInstanced, false>;
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
  const CameraRays::Placement& placement = camera.placement();
  out.camera = {camera.is_perspective(), placement.forward, placement.right_step, placement.up_step};
  out.albedo = ImageRgb(width_px, height_px);
  out.normal = ImageRgb(width_px, height_px);
  out.depth_m = ImageGray(width_px, height_px, std::numeric_limits<float>::infinity());
  out.emission = ImageRgb(width_px, height_px);
  out.object = Image<std::uint32_t>(width_px, height_px);
  out.material = Image<std::uint32_t>(width_px, height_px);
  out.kind = Image<SurfaceKind>(width_px, height_px);

  const GuideFrame frame{scene, lights, camera, settings, width_px, height_px};
  const TraceRays trace = choose_variant(scene, settings.diffuse);
  const auto spp = static_cast<std::size_t>(settings.spp);
  const int tiles_x = (width_px + kTilePx - 1) / kTilePx;
  const int tiles_y = (height_px + kTilePx - 1) / kTilePx;
  // A row of tiles is one task: its workspace is made once.
  parallel_for(static_cast<std::size_t>(tiles_y), threads, [&](std::size_t tile_y) {
    const FlushDenormals flush;
    const auto work = std::make_unique<GuideWorkspace>();
    work->found.resize(kBatchSize * spp);
    const int y0 = static_cast<int>(tile_y) * kTilePx;
    for (int x0 = 0; x0 < tiles_x * kTilePx; x0 += kTilePx) {
      for (std::uint32_t sample = 0; sample < spp; ++sample) {
        trace_tile(frame, trace, x0, y0, sample, *work);
      }
      for (int y = y0; y < std::min(y0 + kTilePx, height_px); ++y) {
        for (int x = x0; x < std::min(x0 + kTilePx, width_px); ++x) {
          const auto place = static_cast<std::size_t>((y - y0) * kTilePx + (x - x0));
          store_pixel(&work->found[place * spp], spp, out.albedo.index(x, y), out);
        }
      }
    }
  });
  if (settings.edge_rays > 0) {
    std::vector<std::vector<EdgeRay>> rows(static_cast<std::size_t>(tiles_y));
    parallel_for(rows.size(), threads, [&](std::size_t tile_y) {
      const FlushDenormals flush;
      const auto work = std::make_unique<GuideWorkspace>();
      work->found.resize(kBatchSize);
      const int y0 = static_cast<int>(tile_y) * kTilePx;
      rows[tile_y] = trace_edges(frame, trace, out, y0, std::min(y0 + kTilePx, height_px), *work);
    });
    for (const std::vector<EdgeRay>& row : rows) {
      out.edge_rays.insert(out.edge_rays.end(), row.begin(), row.end());
    }
  }
  return out;
}

}  // namespace gazetrace
