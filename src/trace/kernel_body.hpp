// SPDX-License-Identifier: Apache-2.0
// The batch path tracer. A batch goes through generate -> intersect -> shade -> shadow, bounce by bounce; each stage
// reads and writes packed arrays in order. The estimator at every scattering event, with f the BSDF:
//   L += throughput * f cos(wi) * L_light / p_light * w_light      (one light sample, a shadow ray)
//   throughput *= f cos(wi) / p_bsdf                                (one BSDF sample, the next ray), and where it ends:
//   L += throughput * L_e * w_bsdf                                  w = power heuristic, exponent 2 (Veach 1997, 9.2)
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "core/hash.hpp"
#include "material/bsdf.hpp"
#include "trace/surface_hit.hpp"

namespace gazetrace {

// From the ratio of the densities: never squares a density, so nothing overflows before the result is 0 or 1.
inline float power_heuristic(float chosen, float other) {
  const float ratio = other / chosen;
  return 1.0F / (1.0F + ratio * ratio);
}

template <KernelFeatures kFeatures, DiffuseModel kDiffuse>
class PathKernel {
 public:
  static void run(const FrameContext& frame, Workspace& work, int count, KernelCounts& counts) {
    PathKernel(frame, work, counts).trace(count);
  }

 private:
  PathKernel(const FrameContext& frame, Workspace& work, KernelCounts& counts)
      : frame_(frame), work_(work), counts_(counts) {}

  void trace(int count) {
    start(count);
    int alive = count;
    const int last = frame_.settings.max_bounces;
    for (int vertex = 0; alive > 0; ++vertex) {
      RayBatch& rays = work_.rays[static_cast<std::size_t>(vertex & 1)];
      (vertex == 0 ? counts_.rays_primary : counts_.rays_bounce) += static_cast<std::uint64_t>(alive);
      if (vertex == last && vertex > 0 && !frame_.last_ray_needs_surface) {
        see_sky(vertex, alive);
        return;
      }
      const RayShape shape = vertex == 0 ? RayShape::coherent_packet : RayShape::single;
      record(rays, alive, shape, false);
      counts_.rejected += static_cast<std::uint64_t>(frame_.scene->rays->intersect(rays, alive, shape, work_.hits));
      shadow_count_ = 0;
      alive = shade(vertex, alive);
      trace_shadows(vertex);
    }
  }

  void record(const RayBatch& rays, int count, RayShape shape, bool occlusion) const {
    if (frame_.recorder != nullptr) {
      frame_.recorder->record(rays, count, shape, occlusion);
    }
  }

  void start(int count) {
    RayBatch& rays = work_.rays[0];
    PathBatch& paths = work_.paths[0];
    const CameraRays& camera = *frame_.camera;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const CameraRays::Ray ray = camera.ray(work_.samples.x[i], work_.samples.y[i]);
      set_ray(rays, i, ray.origin, ray.direction, ray.tnear, ray.tfar);
      rays.alpha_key[i] = alpha_key(i, 0);
      paths.slot[i] = static_cast<std::uint32_t>(i);
      paths.r[i] = 1;
      paths.g[i] = 1;
      paths.b[i] = 1;
      paths.pdf[i] = 0;
      paths.cone_width[i] = camera.cone_width();
      paths.cone_spread[i] = ray.cone_spread;
      work_.radiance.r[i] = 0;
      work_.radiance.g[i] = 0;
      work_.radiance.b[i] = 0;
      work_.radiance.rejected[i] = 0;
    }
    if (frame_.settings.guides) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        work_.guides.hit[i] = 0;
      }
    }
  }

  static void set_ray(RayBatch& rays, std::size_t i, const Vec3f& origin, const Vec3f& direction, float tnear,
                      float tfar) {
    rays.ox[i] = origin.x;
    rays.oy[i] = origin.y;
    rays.oz[i] = origin.z;
    rays.dx[i] = direction.x;
    rays.dy[i] = direction.y;
    rays.dz[i] = direction.z;
    rays.tnear[i] = tnear;
    rays.tfar[i] = tfar;
  }

  // `segment`: twice the vertex, plus one for shadow rays.
  [[nodiscard]] std::uint32_t alpha_key(std::size_t slot, std::uint32_t segment) const {
    const std::uint64_t key = work_.samples.key[slot].value;
    return hash32(static_cast<std::uint32_t>(key >> 32U) ^
                  hash32(work_.samples.sample[slot] ^ hash32(segment + 0x9e3779b9U)));
  }

  void add(std::size_t slot, const Vec3f& radiance) {
    work_.radiance.r[slot] += radiance.x;
    work_.radiance.g[slot] += radiance.y;
    work_.radiance.b[slot] += radiance.z;
  }

  // What a BSDF-sampled ray may count of light it found that light sampling could have found too.
  [[nodiscard]] float weight_of_found_light(int vertex, float pdf_bsdf, float pdf_light) const {
    if (vertex == 0) {
      return 1.0F;
    }
    switch (frame_.settings.light_sampling) {
      case LightSampling::light_only:
        return 0.0F;
      case LightSampling::bsdf_only:
        return 1.0F;
      case LightSampling::mis:
        break;
    }
    return power_heuristic(pdf_bsdf, pdf_light);
  }

  // Rays `list` of a packed batch left the scene.
  void add_sky(int vertex, const RayBatch& rays, const PathBatch& paths, const std::uint16_t* list, std::size_t count) {
    std::array<Vec3f, kChunk> directions;
    std::array<LightSampler::EnvironmentHit, kChunk> sky;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = list[i];
      directions[i] = {rays.dx[k], rays.dy[k], rays.dz[k]};
    }
    frame_.lights->environment_many(directions.data(), count, sky.data());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = list[i];
      const Vec3f throughput{paths.r[k], paths.g[k], paths.b[k]};
      add(paths.slot[k], throughput * sky[i].radiance * weight_of_found_light(vertex, paths.pdf[k], sky[i].pdf));
    }
  }

  // The ray after the last scattering event where only the sky can be found: visibility is enough.
  void see_sky(int vertex, int count) {
    const RayBatch& rays = work_.rays[static_cast<std::size_t>(vertex & 1)];
    const PathBatch& paths = work_.paths[static_cast<std::size_t>(vertex & 1)];
    counts_.rejected +=
        static_cast<std::uint64_t>(frame_.scene->rays->occluded(rays, count, RayShape::single, work_.occluded.data));
    std::array<std::uint16_t, kChunk> sky;
    for (std::size_t begin = 0; begin < static_cast<std::size_t>(count); begin += kChunk) {
      const std::size_t end = std::min(begin + kChunk, static_cast<std::size_t>(count));
      std::size_t sky_count = 0;
      for (std::size_t k = begin; k < end; ++k) {
        sky[sky_count] = static_cast<std::uint16_t>(k);
        sky_count += work_.occluded[k] == 0 ? 1 : 0;
        if (work_.occluded[k] == 2) {
          work_.radiance.rejected[paths.slot[k]] = 1;
        }
      }
      add_sky(vertex, rays, paths, sky.data(), sky_count);
    }
  }

  int shade(int vertex, int count) {
    const auto from = static_cast<std::size_t>(vertex & 1);
    const RayBatch& rays = work_.rays[from];
    const PathBatch& paths = work_.paths[from];
    next_count_ = 0;
    for (std::size_t begin = 0; begin < static_cast<std::size_t>(count); begin += kChunk) {
      shade_chunk(vertex, rays, paths, begin, std::min(begin + kChunk, static_cast<std::size_t>(count)));
    }
    return static_cast<int>(next_count_);
  }

  // In steps over a few dozen rays, so that each step's reads from memory overlap and its arithmetic runs in vectors.
  void shade_chunk(int vertex, const RayBatch& rays, const PathBatch& paths, std::size_t begin, std::size_t end) {
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
        locate_hit<kFeatures>(scene, work_.hits, k, chunk, count++);
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
      chunk.cone_width[i] = paths.cone_width[k];
      chunk.cone_spread[i] = paths.cone_spread[k];
    }
    gather_triangles<kFeatures>(scene, chunk, count);
    place_hits<kFeatures>(chunk, count);
    read_materials<kFeatures>(scene, chunk, count);
    finish_normals<kFeatures>(chunk, count);

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

  // Takes what the surface itself shines; true where the path scatters.
  bool goes_on(int vertex, std::size_t i, const PathBatch& paths) {
    const ChunkHits& chunk = work_.chunk;
    const std::size_t k = chunk.path[i];
    const std::size_t slot = paths.slot[k];
    if (vertex == 0 && frame_.settings.guides) {
      record_guides(slot, i);
    }
    if constexpr (kFeatures.emission) {
      const Vec3f throughput{paths.r[k], paths.g[k], paths.b[k]};
      const ShadingMaterial& material = frame_.scene->materials[chunk.material[i]];
      if (material.unlit) {
        add(slot, throughput * chunk.base_color.get(i));
        return false;
      }
      if (material.emissive && (chunk.side[i] > 0 || material.double_sided)) {
        add_emission(vertex, i, slot, throughput, material, paths.pdf[k]);
      }
    }
    return vertex < frame_.settings.max_bounces;
  }

  void scatter_chunk(int vertex, const PathBatch& paths, std::size_t count, const std::uint16_t* active,
                     std::size_t active_count) {
    const ChunkHits& chunk = work_.chunk;
    std::array<SampleKey, kChunk> key;
    std::array<std::uint32_t, kChunk> index;
    std::array<Vec2f, kChunk> select;
    std::array<Vec2f, kChunk> light_uv;
    std::array<Vec2f, kChunk> bsdf_uv;
    for (std::size_t i = 0; i < kChunk; ++i) {
      const std::size_t slot = i < count ? paths.slot[chunk.path[i]] : 0;
      key[i] = work_.samples.key[slot];
      index[i] = work_.samples.sample[slot];
    }
    const bool lit = frame_.lights->any();
    const bool bounces = vertex + 1 < frame_.settings.max_bounces || frame_.last_ray_finds_light;
    fill_2d(key, index, count, dimension_of(vertex, BounceDimension::select), select);
    if (lit) {
      fill_2d(key, index, count, dimension_of(vertex, BounceDimension::light_uv), light_uv);
    }
    if (bounces) {
      fill_2d(key, index, count, dimension_of(vertex, BounceDimension::bsdf_uv), bsdf_uv);
    }
    std::array<LightSample, kChunk> lights;
    if (lit) {
      std::array<Vec3f, kChunk> positions;
      std::array<Vec3f, kChunk> normals;
      std::array<float, kChunk> choice;
      for (std::size_t i = 0; i < count; ++i) {
        positions[i] = chunk.position.get(i);
        normals[i] = chunk.geometric.get(i);
        choice[i] = select[i].x;
      }
      frame_.lights->sample_many(count, positions.data(), normals.data(), light_uv.data(), choice.data(),
                                 lights.data());
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
    evaluate_lanes(work_.chunk, count, lit, bounces);
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

  static AlbedoTerms terms_of(const std::array<ChunkArray<float>, 4>& terms, std::size_t i) {
    return {terms[0][i], terms[1][i], terms[2][i], terms[3][i]};
  }

  // Table reads do not run in vectors; everything around them does.
  static void read_terms(const ChunkHits& chunk, std::size_t count, const ChunkArray<float>& cosine,
                         std::array<ChunkArray<float>, 4>& out) {
    for (std::size_t i = 0; i < count; ++i) {
      const AlbedoTerms terms =
          albedo_terms({chunk.table_row[i], chunk.table_fraction[i]}, std::clamp(cosine[i], 0.0F, 1.0F));
      out[0][i] = terms.e;
      out[1][i] = terms.b;
      out[2][i] = terms.lambert;
      out[3][i] = terms.burley;
    }
  }

  static Surface surface_of(const ChunkHits& chunk, std::size_t i) {
    return {chunk.base_color.get(i), chunk.metallic[i], chunk.roughness[i]};
  }
  static Bsdf<kDiffuse> bsdf_of(const ChunkHits& chunk, std::size_t i) {
    return {surface_of(chunk, i), chunk.view.get(i), AlbedoRow{chunk.table_row[i], chunk.table_fraction[i]},
            terms_of(chunk.view_terms, i), chunk.e_average[i]};
  }

  // The BSDF of every lane: towards its light sample, and a sample of its own.
  [[gnu::flatten, gnu::noinline]] static void evaluate_lanes(ChunkHits& chunk, std::size_t count, bool lit,
                                                             bool bounces) {
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          const LocalFrame local(chunk.shading.get(i));
          chunk.view.set(i, local.to_local(-chunk.direction.get(i)));
          chunk.light.set(i, local.to_local(chunk.light.get(i)));
          const AlbedoRow row = Bsdf<kDiffuse>::table_row(surface_of(chunk, i));
          chunk.table_row[i] = row.row;
          chunk.table_fraction[i] = row.fraction;
        });
    for (std::size_t i = 0; i < count; ++i) {
      chunk.e_average[i] = albedo_average({chunk.table_row[i], chunk.table_fraction[i]});
    }
    read_terms(chunk, count, chunk.view.z, chunk.view_terms);
    if (lit) {
      read_terms(chunk, count, chunk.light.z, chunk.light_terms);
      for_lanes(
          count, [&](std::size_t i) __attribute__((always_inline)) {
            const BsdfEval eval = bsdf_of(chunk, i).evaluate(chunk.light.get(i), terms_of(chunk.light_terms, i));
            chunk.light_f_cos.set(i, eval.f_cos);
            chunk.light_pdf[i] = eval.pdf;
          });
    }
    if (bounces) {
      for_lanes(
          count, [&](std::size_t i) __attribute__((always_inline)) {
            const auto chosen = bsdf_of(chunk, i).sample_direction(chunk.random.get(i), chunk.random_lobe[i]);
            chunk.next.set(i, chosen.direction);
            chunk.half.set(i, chosen.half);
          });
      read_terms(chunk, count, chunk.next.z, chunk.next_terms);
      for_lanes(
          count, [&](std::size_t i) __attribute__((always_inline)) {
            const BsdfSample sample =
                bsdf_of(chunk, i).weigh({chunk.next.get(i), chunk.half.get(i)}, terms_of(chunk.next_terms, i));
            const Vec3f next = LocalFrame(chunk.shading.get(i)).to_world(sample.direction);
            const Vec3f unit = next * (1.0F / std::sqrt(std::max(dot(next, next), 1e-20F)));
            const bool above = dot(unit, chunk.geometric.get(i)) > 0;
            chunk.next.set(i, unit);
            chunk.next_weight.set(i, sample.weight);
            chunk.next_pdf[i] = sample.pdf;
            chunk.next_good[i] = (static_cast<int>(sample.valid) & static_cast<int>(above)) != 0 ? 1.0F : 0.0F;
          });
    }
  }

  static void fill_2d(const std::array<SampleKey, kChunk>& key, const std::array<std::uint32_t, kChunk>& index,
                      std::size_t count, std::uint32_t dimension, std::array<Vec2f, kChunk>& out) {
    // Separate arrays: the compiler computes 16 at a time.
    alignas(64) std::array<float, kChunk> x;
    alignas(64) std::array<float, kChunk> y;
    for_lanes(
        count, [&](std::size_t i) __attribute__((always_inline)) {
          const Vec2f u = sample_2d(key[i], index[i], dimension);
          x[i] = u.x;
          y[i] = u.y;
        });
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = {x[i], y[i]};
    }
  }

  void take_light_sample(int vertex, std::size_t i, const LightSample& light, const PathBatch& paths) {
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
    const Vec3f arriving = throughput * work_.chunk.light_f_cos.get(i) * (light_radiance(light) * weight);
    if (arriving.x + arriving.y + arriving.z != 0) {
      queue_shadow(vertex, paths.slot[k], i, light, arriving);
    }
  }

  void take_bsdf_sample(int vertex, std::size_t i, const PathBatch& paths) {
    const ChunkHits& chunk = work_.chunk;
    const std::size_t k = chunk.path[i];
    const std::size_t slot = paths.slot[k];
    Vec3f weight = Vec3f{paths.r[k], paths.g[k], paths.b[k]} * chunk.next_weight.get(i);
    if (frame_.settings.russian_roulette && vertex + 1 < frame_.settings.max_bounces && vertex > 0) {
      const float survive = std::min(std::max(std::max(weight.x, weight.y), weight.z), 0.95F);
      if (!(sample_1d(work_.samples.key[slot], work_.samples.sample[slot],
                      dimension_of(vertex, BounceDimension::roulette)) < survive)) {
        return;
      }
      weight = weight * (1.0F / survive);
    }
    const std::size_t to = static_cast<std::size_t>(vertex + 1) & 1U;
    RayBatch& out = work_.rays[to];
    PathBatch& state = work_.paths[to];
    const std::size_t n = next_count_++;
    set_ray(out, n, chunk.origin.get(i), chunk.next.get(i), 0.0F, std::numeric_limits<float>::infinity());
    out.alpha_key[n] = alpha_key(slot, 2U * static_cast<std::uint32_t>(vertex + 1));
    state.slot[n] = static_cast<std::uint32_t>(slot);
    state.r[n] = weight.x;
    state.g[n] = weight.y;
    state.b[n] = weight.z;
    state.pdf[n] = chunk.next_pdf[i];
    state.cone_width[n] = chunk.cone_width[i];
    state.cone_spread[n] =
        chunk.cone_spread[i] + frame_.settings.bounce_cone_rad / std::sqrt(static_cast<float>(kPi) * chunk.next_pdf[i]);
  }

  void add_emission(int vertex, std::size_t i, std::size_t slot, const Vec3f& throughput,
                    const ShadingMaterial& material, float pdf_bsdf) {
    const ChunkHits& chunk = work_.chunk;
    Vec3f emission = material.emission;
    if (material.emit.texture != nullptr) {
      const Vec2f at = coordinates_at<kFeatures>(*frame_.scene, chunk, i, material.emit);
      const Vec4f c = read_texture(*material.emit.texture, at.x, at.y, chunk.lod[i] + material.emit.half_log2_texels);
      emission *= Vec3f{c.x, c.y, c.z};
    }
    float weight = 1;
    if (vertex > 0) {
      float pdf_light = 0;
      const std::uint32_t emitter = emitter_of(i);
      if (emitter != kNoEmitter) {
        // The geometric normal is turned towards the ray; the sampler wants the sign of the front face.
        const float cosine = -dot(chunk.geometric.get(i), chunk.direction.get(i)) * chunk.side[i];
        pdf_light = frame_.lights->pdf_triangle(emitter, cosine, chunk.t[i] * chunk.t[i]);
      }
      weight = weight_of_found_light(vertex, pdf_bsdf, pdf_light);
    }
    add(slot, throughput * emission * weight);
  }

  [[nodiscard]] std::uint32_t emitter_of(std::size_t i) const {
    const RenderScene& scene = *frame_.scene;
    const std::size_t k = work_.chunk.path[i];
    std::uint32_t record = work_.hits.geometry[k];
    std::uint32_t scene_instance = kNoId;
    if constexpr (kFeatures.instances) {
      if (work_.chunk.instance[i] != kNoId) {
        const ShadingInstance& instance = scene.instances[work_.chunk.instance[i]];
        record += instance.first_geometry;
        scene_instance = instance.scene_instance;
      }
    }
    const GeometryRecord& geometry = scene.geometries[record];
    scene_instance = scene_instance == kNoId ? geometry.scene_instance : scene_instance;
    return frame_.lights->emitter_of(scene_instance, geometry.scene_geometry, work_.hits.primitive[k]);
  }

  void record_guides(std::size_t slot, std::size_t i) {
    const ChunkHits& chunk = work_.chunk;
    GuideBatch& guides = work_.guides;
    guides.albedo_r[slot] = chunk.base_color.x[i];
    guides.albedo_g[slot] = chunk.base_color.y[i];
    guides.albedo_b[slot] = chunk.base_color.z[i];
    guides.normal_x[slot] = chunk.shading.x[i];
    guides.normal_y[slot] = chunk.shading.y[i];
    guides.normal_z[slot] = chunk.shading.z[i];
    guides.depth[slot] = chunk.t[i] * dot(chunk.direction.get(i), frame_.camera->forward());
    guides.hit[slot] = 1;
  }

  // A light sample on a textured emitter brings its place instead of the texture's value.
  [[nodiscard]] Vec3f light_radiance(const LightSample& light) const {
    if constexpr (kFeatures.emission) {
      if (light.emitter != kNoEmitter) {
        const EmissiveTriangle& emitter = frame_.lights->triangle(light.emitter);
        const ShadingMaterial& material = frame_.scene->materials[static_cast<std::size_t>(emitter.material)];
        if (material.emit.texture != nullptr) {
          return light.radiance * emitted_texel(emitter, material, light.barycentric);
        }
      }
    }
    return light.radiance;
  }

  [[nodiscard]] Vec3f emitted_texel(const EmissiveTriangle& emitter, const ShadingMaterial& material,
                                    const Vec2f& at) const {
    const Instance& instance = frame_.source->instances[static_cast<std::size_t>(emitter.instance)];
    const Geometry& geometry = frame_.source->meshes[static_cast<std::size_t>(instance.mesh)]
                                   .geometries[static_cast<std::size_t>(emitter.geometry)];
    const auto& corner = geometry.triangles[static_cast<std::size_t>(emitter.primitive)];
    const std::vector<Vec2f>& set = material.emit.uv_set == 1 ? geometry.uv1 : geometry.uv0;
    if (set.size() != geometry.positions.size()) {
      return {1, 1, 1};
    }
    const float w = 1.0F - at.x - at.y;
    const float x = w * set[corner[0]].x + at.x * set[corner[1]].x + at.y * set[corner[2]].x;
    const float y = w * set[corner[0]].y + at.x * set[corner[1]].y + at.y * set[corner[2]].y;
    const auto& m = material.emit.transform;
    const Vec4f c = read_texture(*material.emit.texture, m[0] * x + m[1] * y + m[2], m[3] * x + m[4] * y + m[5], 0.0F);
    return {c.x, c.y, c.z};
  }

  void queue_shadow(int vertex, std::size_t slot, std::size_t i, const LightSample& light, const Vec3f& arriving) {
    const ChunkHits& chunk = work_.chunk;
    ShadowBatch& shadows = work_.shadows;
    const std::size_t n = shadow_count_++;
    // Stops short of the light by what rounding may move either end, so that an emitter does not shadow itself.
    const float tfar = light.distance * (1.0F - 1e-4F) - 2 * chunk.offset[i];
    set_ray(shadows.rays, n, chunk.origin.get(i), light.direction, 0.0F, tfar);
    shadows.rays.alpha_key[n] = alpha_key(slot, 2U * static_cast<std::uint32_t>(vertex) + 1U);
    shadows.slot[n] = static_cast<std::uint32_t>(slot);
    shadows.r[n] = arriving.x;
    shadows.g[n] = arriving.y;
    shadows.b[n] = arriving.z;
  }

  void trace_shadows(int vertex) {
    const int count = static_cast<int>(shadow_count_);
    const ShadowBatch& shadows = work_.shadows;
    const RayShape shape = vertex == 0 ? RayShape::packet : RayShape::single;
    counts_.rays_shadow += shadow_count_;
    record(shadows.rays, count, shape, true);
    counts_.rejected +=
        static_cast<std::uint64_t>(frame_.scene->rays->occluded(shadows.rays, count, shape, work_.occluded.data));
    for (std::size_t n = 0; n < shadow_count_; ++n) {
      if (work_.occluded[n] == 0) {
        add(shadows.slot[n], {shadows.r[n], shadows.g[n], shadows.b[n]});
      } else if (work_.occluded[n] == 2) {
        work_.radiance.rejected[shadows.slot[n]] = 1;
      }
    }
  }

  const FrameContext& frame_;
  Workspace& work_;
  KernelCounts& counts_;
  std::size_t next_count_ = 0, shadow_count_ = 0;
};

}  // namespace gazetrace
