// SPDX-License-Identifier: Apache-2.0
#include "trace/guides.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "trace/first_hit.hpp"
#include "trace/sampler.hpp"

namespace gazetrace {
namespace {

constexpr int kTilePx = 32;
static_assert(kTilePx * kTilePx == kBatchSize);
constexpr int kMostRays = 64;
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
  BatchArray<std::uint16_t> place;  // of each packed ray in its tile, row by row
  BatchArray<float> cone_spread;
  std::vector<FirstHit> found;  // ray after ray of a pixel, pixel after pixel of the tile
};

struct GuideFrame {
  const RenderScene& scene;
  const LightSampler& lights;
  const CameraRays& camera;
  GuideSettings settings;
  int width_px, height_px;
};

// Along a Z-curve, so that a packet of sixteen is a square.
PixelIndex place_on_curve(std::uint32_t i) {
  const auto even_bits = [](std::uint32_t v) {
    v &= 0x55555555U;
    v = (v | (v >> 1U)) & 0x33333333U;
    v = (v | (v >> 2U)) & 0x0f0f0f0fU;
    return static_cast<std::uint16_t>((v | (v >> 4U)) & 0xffU);
  };
  return {even_bits(i), even_bits(i >> 1U)};
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

// Ray `ray` of every pixel of the tile whose corner is (x0, y0).
template <KernelFeatures kFeatures, bool kLayers>
void trace_tile(const GuideFrame& frame, int x0, int y0, int ray, GuideWorkspace& work) {
  const auto spp = static_cast<std::size_t>(frame.settings.spp);
  const float half_width = 0.5F * static_cast<float>(frame.width_px);
  const float half_height = 0.5F * static_cast<float>(frame.height_px);
  const auto cone = static_cast<float>(frame.settings.pixel_cone);
  const auto sample = static_cast<std::uint32_t>(ray);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < kBatchSize; ++i) {
    const PixelIndex at = place_on_curve(i);
    const int x = x0 + at.x;
    const int y = y0 + at.y;
    if (x >= frame.width_px || y >= frame.height_px) {
      continue;
    }
    const SampleKey key{hash64(kPlaceKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x)))};
    const Vec2f inside = spp == 1 ? Vec2f{0.5F, 0.5F} : sample_2d(key, sample, dimension_of(PathDimension::pixel));
    const CameraRays::Ray camera_ray = frame.camera.ray((static_cast<float>(x) - half_width) + inside.x,
                                                        (static_cast<float>(y) - half_height) + inside.y);
    RayBatch& rays = work.rays;
    rays.ox[count] = camera_ray.origin.x;
    rays.oy[count] = camera_ray.origin.y;
    rays.oz[count] = camera_ray.origin.z;
    rays.dx[count] = camera_ray.direction.x;
    rays.dy[count] = camera_ray.direction.y;
    rays.dz[count] = camera_ray.direction.z;
    rays.tnear[count] = camera_ray.tnear;
    rays.tfar[count] = camera_ray.tfar;
    rays.time[count] = 0.5F;
    rays.alpha_key[count] = hash32(static_cast<std::uint32_t>(key.value >> 32U) ^ hash32(sample));
    work.cone_spread[count] = camera_ray.cone_spread * cone;
    work.place[count] = static_cast<std::uint16_t>(at.y * kTilePx + at.x);
    ++count;
  }
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
      FirstHit& miss = work.found[work.place[k] * spp + sample];
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
      work.found[work.place[chunk.path[i]] * spp + sample] = first_hit<kFeatures, kLayers>(frame, work.hits, chunk, i);
    }
  }
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

using TraceTile = void (*)(const GuideFrame&, int x0, int y0, int ray, GuideWorkspace&);

// The smallest variant that covers the scene.
TraceTile choose_variant(const RenderScene& scene, DiffuseModel diffuse) {
  constexpr KernelFeatures kTextured{.textures = true};
  constexpr KernelFeatures kInstanced{.textures = true, .instances = true, .extras = true};
  if (scene.features.layers.any() && diffuse != DiffuseModel::matte) {
    return trace_tile<kInstanced, true>;
  }
  return scene.instances.empty() && scene.extras.empty() ? trace_tile<kTextured, false> : trace_tile<kInstanced, false>;
}

}  // namespace

void check_guides(const GuideSettings& settings) {
  if (settings.spp < 1 || settings.spp > kMostRays) {
    throw Error(ErrorKind::usage, "guides", std::to_string(settings.spp) + " rays a pixel",
                "ask for 1 to " + std::to_string(kMostRays));
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
  const TraceTile trace = choose_variant(scene, settings.diffuse);
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
      for (int ray = 0; ray < settings.spp; ++ray) {
        trace(frame, x0, y0, ray, *work);
      }
      for (int y = y0; y < std::min(y0 + kTilePx, height_px); ++y) {
        for (int x = x0; x < std::min(x0 + kTilePx, width_px); ++x) {
          const auto place = static_cast<std::size_t>((y - y0) * kTilePx + (x - x0));
          store_pixel(&work->found[place * spp], spp, out.albedo.index(x, y), out);
        }
      }
    }
  });
  return out;
}

}  // namespace gazetrace
