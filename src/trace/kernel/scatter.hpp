// SPDX-License-Identifier: Apache-2.0
// The scattering event: one light sample and one BSDF sample for every hit of a chunk.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/hash.hpp"
#include "trace/kernel/bsdf_lanes.hpp"
#include "trace/kernel/path_kernel.hpp"
#include "trace/kernel/shading_frame.hpp"

namespace gazetrace {

template <bool kLayers>
inline void PathKernel<kLayers>::scatter_chunk(int vertex, const PathBatch& paths, std::size_t count,
                                               const std::uint16_t* active, std::size_t active_count) {
  const ChunkHits& chunk = work_.chunk;
  std::array<SampleKey, kChunk> key;
  std::array<std::uint32_t, kChunk> index;
  std::array<Vec2f, kChunk> select;
  std::array<Vec2f, kChunk> light_uv;
  std::array<Vec2f, kChunk> bsdf_uv;
  for (std::size_t i = 0; i < kChunk; ++i) {
    const std::size_t slot = i < count ? paths.slot[chunk.path[i]] : 0;
    key[i] = work_.samples.key[slot];
    index[i] = work_.samples.index[slot];
  }
  // What a first surface sees of the lights teaches nothing of its bounces.
  const bool lit = frame_.lights->any() && !(frame_.records_bounces && vertex == 0);
  const bool bounces = scatters_at(vertex + 1) || frame_.last_ray_finds_light;
  fill_2d(key, index, count, dimension_of(vertex, BounceDimension::select), select);
  if (lit) {
    fill_2d(key, index, count, dimension_of(vertex, BounceDimension::light_uv), light_uv);
  }
  if (bounces) {
    fill_2d(key, index, count, dimension_of(vertex, BounceDimension::bsdf_uv), bsdf_uv);
  }
  std::array<Vec3f, kChunk> positions;
  std::array<Vec3f, kChunk> normals;
  if (frame_.lights->any()) {
    for (std::size_t i = 0; i < count; ++i) {
      normals[i] = lit_side(i);
      positions[i] = lit_point(i, normals[i]);
    }
    if (frame_.lights->depends_on_place()) {
      for (std::size_t i = 0; i < count; ++i) {
        work_.chunk.lit_point.set(i, positions[i]);
        work_.chunk.lit_normal.set(i, normals[i]);
      }
    }
  }
  std::array<LightSample, kChunk> lights;
  if (lit) {
    std::array<float, kChunk> choice;
    for (std::size_t i = 0; i < count; ++i) {
      choice[i] = select[i].x;
    }
    frame_.lights->sample_many(count, positions.data(), normals.data(), light_uv.data(), choice.data(), lights.data());
  }
  if (lit) {
    for (std::size_t i = 0; i < count; ++i) {
      work_.chunk.light.set(i, lights[i].direction);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    work_.chunk.random.set(i, bsdf_uv[i]);
    work_.chunk.random_lobe[i] = select[i].y;
  }
  const bool guided = frame_.guiding_field != nullptr && bounces;
  if (guided) {
    find_cells(count);
  }
  evaluate_lanes(frame_.settings.diffuse, work_.chunk, count, lit, bounces, guided ? frame_.guiding_field : nullptr);
  if (guided) {
    mix_densities(count, lit ? lights.data() : nullptr, bounces);
  }
  if (has_layers()) {
    scatter_layers(vertex, active, active_count, lit ? lights.data() : nullptr, bounces);
  }
  if (vertex == 0 && frame_.settings.light_groups) {
    find_diffuse_shares(active, active_count, lit ? lights.data() : nullptr, bounces);
  }
  for (std::size_t a = 0; a < active_count; ++a) {
    const std::size_t i = active[a];
    if (lit && lights[i].valid) {
      take_light_sample(vertex, i, lights[i], paths);
    }
    if (bounces && chunk.next_good[i] != 0) {
      take_bsdf_sample(vertex, i, paths);
    }
  }
}

template <bool kLayers>
inline void PathKernel<kLayers>::take_light_sample(int vertex, std::size_t i, const LightSample& light,
                                                   const PathBatch& paths) {
  const LightSampling mode = frame_.settings.light_sampling;
  if (!light.delta && mode == LightSampling::bsdf_only) {
    return;
  }
  float weight = 1.0F / light.pdf;
  if (!light.delta && mode == LightSampling::mis) {
    weight *= power_heuristic(light.pdf, work_.chunk.light_pdf[i]);
  }
  const std::size_t k = work_.chunk.path[i];
  const Vec3f throughput{paths.r[k], paths.g[k], paths.b[k]};
  Vec3f arriving = throughput * work_.chunk.light_f_cos.get(i) * (light_radiance(light) * weight);
  if (has_layers()) {
    const std::uint32_t body = body_after(i, paths, leaves_through(i, light.direction));
    if (body != kNoId) {
      arriving *= transmittance(frame_.scene->layered.materials[body].absorption_per_m, light.distance);
    }
  }
  arriving = clamped(vertex + 1, arriving);
  if (arriving.x + arriving.y + arriving.z != 0) {
    queue_shadow(vertex, paths.slot[k], i, light, arriving);
  }
}

template <bool kLayers>
inline void PathKernel<kLayers>::take_bsdf_sample(int vertex, std::size_t i, const PathBatch& paths) {
  const ChunkHits& chunk = work_.chunk;
  const std::size_t k = chunk.path[i];
  const std::size_t slot = paths.slot[k];
  Vec3f weight = Vec3f{paths.r[k], paths.g[k], paths.b[k]} * chunk.next_weight.get(i);
  if (frame_.settings.russian_roulette && scatters_at(vertex + 1) && vertex > 1) {
    const float survive = std::min(std::sqrt(std::max(std::max(weight.x, weight.y), weight.z)), 0.95F);
    if (!(sample_1d(work_.samples.key[slot], work_.samples.index[slot],
                    dimension_of(vertex, BounceDimension::roulette)) < survive)) {
      return;
    }
    weight = weight * (1.0F / survive);
  }
  const std::size_t to = static_cast<std::size_t>(vertex + 1) & 1U;
  RayBatch& out = work_.rays[to];
  PathBatch& state = work_.paths[to];
  const std::size_t n = next_count_++;
  if (vertex == 0 && frame_.settings.light_groups) {
    work_.groups.diffuse.set(slot, chunk.next_diffuse.get(i));
  }
  const Vec3f direction = chunk.next.get(i);
  set_ray(out, n, leaving_point(i, direction), direction, 0.0F, std::numeric_limits<float>::infinity());
  if (has_layers()) {
    state.body[n] = body_after(i, paths, leaves_through(i, direction));
  }
  out.alpha_key[n] = alpha_key(slot, 2U * static_cast<std::uint32_t>(vertex + 1));
  state.slot[n] = static_cast<std::uint32_t>(slot);
  state.r[n] = weight.x;
  state.g[n] = weight.y;
  state.b[n] = weight.z;
  state.pdf[n] = chunk.next_pdf[i];
  if (frame_.records_bounces && vertex < kRecordedBounces) {
    const bool mixed =
        frame_.guiding_field != nullptr && chunk.table_share[i] > 0;  // layered materials have a share of 0
    const float bsdf_pdf = mixed ? chunk.next_bsdf_pdf[i] : chunk.next_pdf[i];
    work_.bounces.push_back(
        {{chunk.position.get(i), chunk.shading.get(i), direction, chunk.next_pdf[i], bsdf_pdf, 0.0F, 0U},
         luminance(weight),
         0.0F,
         static_cast<std::uint32_t>(slot)});
  }
  if (frame_.lights->depends_on_place()) {
    state.lit_point.set(n, chunk.lit_point.get(i));
    state.lit_normal.set(n, chunk.lit_normal.get(i));
  }
}

}  // namespace gazetrace
