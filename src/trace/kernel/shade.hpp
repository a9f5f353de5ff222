// SPDX-License-Identifier: Apache-2.0
// Shades hits: gathers their triangles, computes their positions, reads textures and turns normals to the ray; then
// adds emission and scatters.
#pragma once

#include <algorithm>
#include <array>

#include "trace/guides/first_hit.hpp"
#include "trace/kernel/path_kernel.hpp"
#include "trace/kernel/surface_hit.hpp"

namespace gazetrace {

template <bool kLayers>
inline int PathKernel<kLayers>::shade(int vertex, int count) {
  const auto from = static_cast<std::size_t>(vertex & 1);
  const RayBatch& rays = work_.rays[from];
  const PathBatch& paths = work_.paths[from];
  next_count_ = 0;
  for (std::size_t begin = 0; begin < static_cast<std::size_t>(count); begin += kChunk) {
    shade_chunk(vertex, rays, paths, begin, std::min(begin + kChunk, static_cast<std::size_t>(count)));
  }
  return static_cast<int>(next_count_);
}

// Each step is done for a few dozen rays, so that its reads from memory overlap and its arithmetic vectorises.
template <bool kLayers>
inline void PathKernel<kLayers>::shade_chunk(int vertex, const RayBatch& rays, const PathBatch& paths,
                                             std::size_t begin, std::size_t end) {
  const RenderScene& scene = *frame_.scene;
  ChunkHits& chunk = work_.chunk;
  std::array<std::uint16_t, kChunk> sky;
  std::size_t sky_count = 0;
  std::size_t count = 0;
  for (std::size_t k = begin; k < end; ++k) {
    const std::uint32_t geometry = work_.hits.geometry[k];
    if (geometry == kRejected) {
      work_.radiance.rejected[paths.slot[k]] = 1;
    } else if (geometry == kNoId) {
      sky[sky_count++] = static_cast<std::uint16_t>(k);
    } else {
      locate_hit(scene, work_.hits, k, chunk, count++);
    }
  }
  add_sky(vertex, rays, paths, sky.data(), sky_count);
  if (count == 0) {
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = chunk.path[i];
    chunk.direction.set(i, {rays.dx[k], rays.dy[k], rays.dz[k]});
    chunk.u[i] = work_.hits.u[k];
    chunk.v[i] = work_.hits.v[k];
    chunk.t[i] = work_.hits.t[k];
    // The samples of a pixel average textures at full resolution, after a bounce, too: coarser levels there bias the
    // mean, and were measured to save no noise and a few per cent of the time (tests/benchmarks/book/sampling.md).
    chunk.cone_width[i] = chunk.cone_spread[i] = 0;
  }
  gather_triangles(scene, rays.time, chunk, count);
  place_hits(chunk, count);
  read_materials(scene, chunk, count);
  if (has_layers()) {
    chunk.smooth = chunk.shading;
    absorb(vertex, count);
  }
  finish_normals(chunk, count);

  std::array<std::uint16_t, kChunk> active;
  std::size_t active_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    active[active_count] = static_cast<std::uint16_t>(i);
    active_count += chunk.good[i] != 0 && goes_on(vertex, i, paths) ? 1 : 0;
  }
  if (active_count > 0) {
    scatter_chunk(vertex, paths, count, active.data(), active_count);
  }
}

// Adds the emission of the surface; true where the path scatters.
template <bool kLayers>
inline bool PathKernel<kLayers>::goes_on(int vertex, std::size_t i, const PathBatch& paths) {
  const ChunkHits& chunk = work_.chunk;
  const std::size_t k = chunk.path[i];
  const std::size_t slot = paths.slot[k];
  if (vertex == 0 && frame_.settings.guides) {
    record_guides(slot, i);
  }
  if (vertex == 0 && frame_.settings.surfaces) {
    record_surface(slot, i);
  }
  const Vec3f throughput{paths.r[k], paths.g[k], paths.b[k]};
  const ShadingMaterial& material = frame_.scene->materials[chunk.material[i]];
  counts_.backs += vertex == 0 && chunk.side[i] < 0 && !material.double_sided ? 1 : 0;
  if (material.unlit) {
    add(slot, clamped(vertex, throughput * chunk.base_color.get(i)), vertex);
    return false;
  }
  if (material.emissive && (chunk.side[i] > 0 || material.double_sided)) {
    add_emission(vertex, i, slot, throughput, material, paths.pdf[k]);
  }
  return scatters_at(vertex);
}

template <bool kLayers>
inline void PathKernel<kLayers>::record_guides(std::size_t slot, std::size_t i) {
  const ChunkHits& chunk = work_.chunk;
  GuideBatch& guides = work_.guides;
  guides.albedo_r[slot] = chunk.base_color.x[i];
  guides.albedo_g[slot] = chunk.base_color.y[i];
  guides.albedo_b[slot] = chunk.base_color.z[i];
  guides.normal_x[slot] = chunk.shading.x[i];
  guides.normal_y[slot] = chunk.shading.y[i];
  guides.normal_z[slot] = chunk.shading.z[i];
  const CameraRays& camera = *frame_.camera;
  const Vec3f forward = camera.moves() ? camera.placement_at(time_of(slot)).forward : camera.forward();
  guides.depth[slot] = chunk.t[i] * dot(chunk.direction.get(i), forward);
  guides.hit[slot] = 1;
}

template <bool kLayers>
inline void PathKernel<kLayers>::record_surface(std::size_t slot, std::size_t i) {
  const ChunkHits& chunk = work_.chunk;
  SurfaceBatch& out = work_.surfaces;
  const Vec3f albedo = albedo_to_divide_by(*frame_.scene, chunk, i, frame_.settings.diffuse);
  const Vec3f position = frame_.scene->blurs ? position_in_mid_time(i) : chunk.position.get(i);
  const Vec3f place = position - frame_.camera->origin();
  out.albedo_r[slot] = albedo.x;
  out.albedo_g[slot] = albedo.y;
  out.albedo_b[slot] = albedo.z;
  out.normal_x[slot] = chunk.shading.x[i];
  out.normal_y[slot] = chunk.shading.y[i];
  out.normal_z[slot] = chunk.shading.z[i];
  out.place_x[slot] = place.x;
  out.place_y[slot] = place.y;
  out.place_z[slot] = place.z;
  out.kind[slot] = kind_of_hit(*frame_.scene, chunk, i, frame_.settings.diffuse);
  out.blended[slot] = frame_.scene->materials[chunk.material[i]].alpha_mode == AlphaMode::blend ? 1 : 0;
}

// Where the point of the surface that a sample hit is in the middle of the time for which the shutter is open.
template <bool kLayers>
inline Vec3f PathKernel<kLayers>::position_in_mid_time(std::size_t i) const {
  const ChunkHits& chunk = work_.chunk;
  if (chunk.instance[i] != kNoId) {
    constexpr float kMiddle = 0.5F;
    const RenderScene& scene = *frame_.scene;
    const ShadingInstance& now = scene.instances[chunk.instance[i]];
    if (now.way == kNoId && now.shape_way == kNoId) {
      return chunk.position.get(i);
    }
    const ShadingInstance instance = scene.instance_at(chunk.instance[i], kMiddle);
    const std::uint32_t triangle = chunk.triangle[i];
    const std::array<Vec3f, 3> corner = instance.shape_way != kNoId
                                            ? scene.shape_ways[instance.shape_way].at(triangle, kMiddle).position
                                            : scene.triangles[triangle].position;
    const float u = chunk.u[i];
    const float v = chunk.v[i];
    return apply_columns(instance.axes, corner[0] * (1.0F - u - v) + corner[1] * u + corner[2] * v) +
           instance.translation;
  }
  return chunk.position.get(i);
}

// How far what the camera rays hit is from where the pinhole of the frame's mid-time sees it. Call it before the camera
// rays are overwritten.
template <bool kLayers>
inline void PathKernel<kLayers>::find_shifts(std::size_t count) {
  const CameraRays& camera = *frame_.camera;
  SurfaceBatch& out = work_.surfaces;
  const RayBatch& rays = work_.rays[0];
  for (std::size_t i = 0; i < count; ++i) {
    const bool misses = out.kind[i] == SurfaceKind::miss;
    const Vec3f way =
        misses ? Vec3f{rays.dx[i], rays.dy[i], rays.dz[i]} : Vec3f{out.place_x[i], out.place_y[i], out.place_z[i]};
    const Vec2f seen = camera.pixel_of(way);
    const Vec2f shift{seen.x - work_.samples.x[i], seen.y - work_.samples.y[i]};
    const float square = shift.x * shift.x + shift.y * shift.y;
    // An orthographic camera sees the same sky in all of its pixels. What is behind the pinhole it sees nowhere.
    constexpr float kMost = kMostShiftPx * kMostShiftPx;
    const bool is_known = camera.is_perspective() || !misses;
    out.square_shift_px2[i] = is_known ? (square < kMost ? square : kMost) : 0.0F;
  }
}

// Keeps the radiance that the camera rays themselves found. Call it before the first shadow rays are traced.
template <bool kLayers>
inline void PathKernel<kLayers>::keep_shone(std::size_t count) {
  std::copy_n(work_.radiance.r.data, count, work_.surfaces.shone_r.data);
  std::copy_n(work_.radiance.g.data, count, work_.surfaces.shone_g.data);
  std::copy_n(work_.radiance.b.data, count, work_.surfaces.shone_b.data);
}

}  // namespace gazetrace
