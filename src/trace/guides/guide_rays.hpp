// SPDX-License-Identifier: Apache-2.0
// Batches of rays for guides: adding rays, tracing them, and shading their first hits.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "gazetrace/guides.hpp"
#include "trace/guides/first_hit.hpp"
#include "trace/guides/primary_rays.hpp"

namespace gazetrace {

inline constexpr std::uint64_t kGuideKey =
    0x67756964657321ULL;  // keeps alpha hashes apart from those of traced samples

// A unit vector with an error of up to half a degree, or zero.
struct RoughNormal {
  std::int8_t x = 0, y = 0, z = 0;
};
inline RoughNormal rough_normal(const Vec3f& n) {
  const auto code = [](float c) { return static_cast<std::int8_t>(static_cast<int>(c * 127.0F + 127.5F) - 127); };
  return {code(n.x), code(n.y), code(n.z)};
}
// The cosine of the angle between two of them.
inline float facing(const RoughNormal& a, const RoughNormal& b) {
  return static_cast<float>(a.x * b.x + a.y * b.y + a.z * b.z) * (1.0F / (127.0F * 127.0F));
}

struct FirstHit {
  Vec3f albedo{1, 1, 1};
  Vec3f normal;
  Vec3f emission;
  float depth_m = std::numeric_limits<float>::infinity();
  std::uint32_t object = 0, material = 0;
  SurfaceKind kind = SurfaceKind::miss;
  RoughNormal smooth;  // interpolated over the triangle, towards the camera: what is left of `normal` without bumps
};

struct GuideWorkspace {
  RayBatch rays;
  HitBatch hits;
  ChunkHits chunk;
  std::size_t count = 0;            // number of rays that were added
  BatchArray<std::uint32_t> place;  // index of each of them into `found`
  BatchArray<float> cone_spread;
  std::vector<FirstHit> found;
};

struct GuideFrame {
  const RenderScene& scene;
  const LightSampler& lights;
  const CameraRays& camera;
  GuideSettings settings;
  int width_px, height_px;
};

inline Vec2f from_center(const GuideFrame& frame, int x, int y, const Vec2f& inside) {
  return {(static_cast<float>(x) - 0.5F * static_cast<float>(frame.width_px)) + inside.x,
          (static_cast<float>(y) - 0.5F * static_cast<float>(frame.height_px)) + inside.y};
}

// Adds a ray for pixel (x, y) through continuous pixel coordinates from the frame's centre.
inline void add_ray(const GuideFrame& frame, const Vec2f& through, int x, int y, std::uint32_t sample,
                    std::size_t place, GuideWorkspace& work) {
  const CameraRays::Ray ray = frame.camera.ray(through.x, through.y);
  const std::uint64_t key = hash64(kGuideKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x)));
  const std::size_t k = work.count++;
  put_camera_ray(ray, hash32(static_cast<std::uint32_t>(key >> 32U) ^ hash32(sample)), k, work.rays);
  work.cone_spread[k] = ray.cone_spread * static_cast<float>(frame.settings.pixel_cone);
  work.place[k] = static_cast<std::uint32_t>(place);
}

inline void intersect_rays(const GuideFrame& frame, std::size_t count, GuideWorkspace& work) {
  frame.scene.rays->intersect(work.rays, static_cast<int>(count), RayShape::coherent_packet, work.hits);
}

inline bool is_hit(const HitBatch& hits, std::size_t k) {
  return hits.geometry[k] != kNoId && hits.geometry[k] != kRejected;
}

inline FirstHit first_miss(const GuideFrame& frame, const GuideWorkspace& work, std::size_t k) {
  FirstHit miss;
  if (work.hits.geometry[k] == kNoId) {
    miss.emission = frame.lights.environment_radiance({work.rays.dx[k], work.rays.dy[k], work.rays.dz[k]});
  }
  return miss;
}

// Finds the triangles, positions and unbumped normals of the `count` hits that were located in work.chunk.
inline void place_first_hits(const GuideFrame& frame, std::size_t count, GuideWorkspace& work) {
  ChunkHits& chunk = work.chunk;
  const auto cone = static_cast<float>(frame.settings.pixel_cone);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = chunk.path[i];
    chunk.direction.set(i, {work.rays.dx[k], work.rays.dy[k], work.rays.dz[k]});
    chunk.u[i] = work.hits.u[k];
    chunk.v[i] = work.hits.v[k];
    chunk.t[i] = work.hits.t[k];
    chunk.cone_width[i] = frame.camera.cone_width() * cone;
    chunk.cone_spread[i] = work.cone_spread[k];
  }
  gather_triangles(frame.scene, work.rays.time, chunk, count);
  place_hits(chunk, count);
}

// Call it after place_first_hits and before normals are finished.
inline RoughNormal smooth_normal(const ChunkHits& chunk, std::size_t i) {
  return rough_normal(chunk.shading.get(i) * chunk.side[i]);
}

// The ideal Lambertian model has no layers.
inline bool has_layers(const GuideFrame& frame) {
  return frame.scene.features.layers.any() && frame.settings.diffuse != DiffuseModel::matte;
}

inline FirstHit first_hit(const GuideFrame& frame, const HitBatch& hits, const ChunkHits& chunk, std::size_t i) {
  const RenderScene& scene = frame.scene;
  const ShadingMaterial& material = scene.materials[chunk.material[i]];
  FirstHit hit;
  hit.albedo = albedo_to_divide_by(scene, chunk, i, frame.settings.diffuse);
  hit.normal = chunk.shading.get(i);
  hit.depth_m = chunk.t[i] * dot(chunk.direction.get(i), frame.camera.forward());
  hit.object = 1 + scene_instance_of(scene, hits, chunk.path[i], chunk, i);
  hit.material = 1 + chunk.material[i];
  hit.kind = kind_of_hit(scene, chunk, i, frame.settings.diffuse);
  if (material.unlit) {
    hit.emission = chunk.base_color.get(i);
  } else if (material.emissive && (chunk.side[i] > 0 || material.double_sided)) {
    hit.emission = emitted_radiance(scene, chunk, i, material, has_layers(frame));
  }
  return hit;
}

// Shades the hits of work.chunk and stores them in work.found at their rays' places. Call it after place_first_hits.
inline void shade_first_hits(const GuideFrame& frame, std::size_t count, GuideWorkspace& work) {
  ChunkHits& chunk = work.chunk;
  read_materials(frame.scene, chunk, count);
  if (has_layers(frame)) {
    chunk.smooth = chunk.shading;
  }
  std::array<RoughNormal, kChunk> smooth;
  for (std::size_t i = 0; i < count; ++i) {
    smooth[i] = smooth_normal(chunk, i);
  }
  finish_normals(chunk, count);
  for (std::size_t i = 0; i < count; ++i) {
    FirstHit& hit = work.found[work.place[chunk.path[i]]];
    hit = first_hit(frame, work.hits, chunk, i);
    hit.smooth = smooth[i];
  }
}

}  // namespace gazetrace
