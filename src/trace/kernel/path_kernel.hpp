// SPDX-License-Identifier: Apache-2.0
// The batch path tracer. A batch goes through generate -> intersect -> shade -> shadow, bounce by bounce; each stage
// reads and writes packed arrays in order. The estimator at every scattering event, with f the BSDF:
//   L += throughput * f cos(wi) * L_light / p_light * w_light      (one light sample, a shadow ray)
//   throughput *= f cos(wi) / p_bsdf                                (one BSDF sample, the next ray), and where it ends:
//   L += throughput * L_e * w_bsdf                                  w = power heuristic, exponent 2 (Veach 1997, 9.2)
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/hash.hpp"
#include "core/instruction_sets.hpp"
#include "core/luminance.hpp"
#include "trace/kernel/chunk.hpp"
#include "trace/kernel/kernel.hpp"

namespace gazetrace {

// Computed from the ratio of the densities. No density is squared, so nothing overflows before the result is 0 or 1.
inline float power_heuristic(float chosen, float other) {
  const float ratio = other / chosen;
  return 1.0F / (1.0F + ratio * ratio);
}

// `kLayers`: with the code of materials with extensions.
template <bool kLayers>
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
    for (int vertex = 0; alive > 0; ++vertex) {
      RayBatch& rays = work_.rays[static_cast<std::size_t>(vertex & 1)];
      (vertex == 0 ? counts_.rays_primary : counts_.rays_bounce) += static_cast<std::uint64_t>(alive);
      stamp(rays, work_.paths[static_cast<std::size_t>(vertex & 1)].slot, static_cast<std::size_t>(alive));
      if (vertex > 0 && !scatters_at(vertex) && !frame_.last_ray_needs_surface) {
        see_sky(vertex, alive);
        return;
      }
      const RayShape shape = vertex == 0 && !frame_.single_rays ? RayShape::coherent_packet : RayShape::single;
      record(rays, alive, shape, false);
      counts_.rejected +=
          static_cast<std::uint64_t>(frame_.scene->rays->intersect(rays, alive, shape, work_.hits, vertex == 0));
      shadow_count_ = 0;
      const std::size_t first_bounce = work_.bounces.size();
      alive = shade(vertex, alive);
      if (vertex == 0 && frame_.settings.surfaces) {
        keep_shone(static_cast<std::size_t>(count));
        if (frame_.shifts_hits) {
          find_shifts(static_cast<std::size_t>(count));
        } else {
          std::fill_n(work_.surfaces.square_shift_px2.data, count, 0.0F);
        }
      }
      trace_shadows(vertex);
      for (std::size_t i = first_bounce; i < work_.bounces.size(); ++i) {
        const std::size_t slot = work_.bounces[i].slot;
        work_.bounces[i].shone_before =
            luminance(Vec3f{work_.radiance.r[slot], work_.radiance.g[slot], work_.radiance.b[slot]});
      }
    }
  }

  [[nodiscard]] bool scatters_at(int vertex) const { return vertex < frame_.settings.max_bounces; }

  // The ideal Lambertian model has no layers.
  [[nodiscard]] bool has_layers() const { return kLayers && frame_.settings.diffuse != DiffuseModel::matte; }

  void record(const RayBatch& rays, int count, RayShape shape, bool occlusion) const {
    if (frame_.recorder != nullptr) {
      frame_.recorder->record(rays, count, shape, occlusion);
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

  // `segment` is twice the number of the vertex, plus one for shadow rays.
  [[nodiscard]] std::uint32_t alpha_key(std::size_t slot, std::uint32_t segment) const {
    const std::uint64_t key = work_.samples.key[slot].value;
    return hash32(static_cast<std::uint32_t>(key >> 32U) ^
                  hash32(work_.samples.index[slot] ^ hash32(segment + 0x9e3779b9U)));
  }

  // The time of the sample in [0, 1), where 0 is the opening of the shutter.
  [[nodiscard]] float time_of(std::size_t slot) const {
    return sample_1d(work_.samples.key[slot], work_.samples.index[slot], dimension_of(PathDimension::time));
  }

  // Rays get the time of their sample only where something moves while the shutter is open.
  void stamp(RayBatch& rays, const BatchArray<std::uint32_t>& slots, std::size_t count) const {
    if (!frame_.scene->blurs) {
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      rays.time[i] = time_of(slots[i]);
    }
  }

  // `events`: how many surfaces scattered the light on its way to the camera.
  void add(std::size_t slot, const Vec3f& radiance, int events, LightGroup seen = LightGroup::emission) {
    work_.radiance.r[slot] += radiance.x;
    work_.radiance.g[slot] += radiance.y;
    work_.radiance.b[slot] += radiance.z;
    if (frame_.settings.light_groups) {
      add_to_groups(slot, radiance, events, seen, work_.groups.diffuse.get(slot));
    }
  }

  // Applies TraceSettings::clamp_indirect; `events` is the number of scattering events between the light and the
  // camera.
  [[nodiscard]] Vec3f clamped(int events, const Vec3f& radiance) const {
    const auto limit = static_cast<float>(frame_.settings.clamp_indirect);
    if (!(limit > 0) || events < 2) {
      return radiance;
    }
    const float most = std::max(std::max(radiance.x, radiance.y), radiance.z);
    return most > limit ? radiance * (limit / most) : radiance;
  }
  // The origin of a ray that leaves hit i, off the surface on the side of the direction.
  [[nodiscard]] Vec3f leaving_point(std::size_t i, const Vec3f& direction) const {
    const ChunkHits& chunk = work_.chunk;
    if (has_layers()) {
      if (leaves_through(i, direction)) {
        return chunk.position.get(i) - chunk.geometric.get(i) * chunk.offset[i];
      }
    }
    return chunk.origin.get(i);
  }
  [[nodiscard]] bool leaves_through(std::size_t i, const Vec3f& direction) const {
    return dot(direction, work_.chunk.geometric.get(i)) < 0;
  }
  // The normal of the side that light must come from; zero where it may come from both.
  [[nodiscard]] Vec3f lit_side(std::size_t i) const {
    if (has_layers()) {
      const LayeredMaterial* material = frame_.scene->layered.of(work_.chunk.material[i]);
      if (material != nullptr && material->transmits) {
        return {};
      }
    }
    return work_.chunk.geometric.get(i);
  }
  // The point for which the lights of hit i are chosen. Where their densities depend on it, it is the origin of the
  // next ray, so that both ways of finding a light use the same density; where that ray may leave on either side, it is
  // midway between the two origins.
  [[nodiscard]] Vec3f lit_point(std::size_t i, const Vec3f& side) const {
    const bool one_side = side.x != 0 || side.y != 0 || side.z != 0;
    return frame_.lights->depends_on_place() && one_side ? work_.chunk.origin.get(i) : work_.chunk.position.get(i);
  }

  // generate.hpp
  GAZETRACE_CLONES void start(int count);

  // sky.hpp
  [[nodiscard]] float weight_of_found_light(int vertex, float pdf_bsdf, float pdf_light) const;
  void add_sky(int vertex, const RayBatch& rays, const PathBatch& paths, const std::uint16_t* list, std::size_t count);
  void see_sky(int vertex, int count);

  // shade.hpp
  int shade(int vertex, int count);
  void shade_chunk(int vertex, const RayBatch& rays, const PathBatch& paths, std::size_t begin, std::size_t end);
  bool goes_on(int vertex, std::size_t i, const PathBatch& paths);
  void record_guides(std::size_t slot, std::size_t i);
  void record_surface(std::size_t slot, std::size_t i);
  void keep_shone(std::size_t count);
  [[nodiscard]] Vec3f position_in_mid_time(std::size_t i) const;
  void find_shifts(std::size_t count);

  // emission.hpp
  void add_emission(int vertex, std::size_t i, std::size_t slot, const Vec3f& throughput,
                    const ShadingMaterial& material, float pdf_bsdf);
  [[nodiscard]] std::uint32_t emitter_of(std::size_t i) const;
  [[nodiscard]] Vec3f light_radiance(const LightSample& light) const;
  [[nodiscard]] const Geometry& geometry_of(const EmissiveTriangle& emitter) const;
  [[nodiscard]] Vec2f place_on_emitter(const EmissiveTriangle& emitter, const ShadingTexture& texture,
                                       const Vec2f& at) const;
  [[nodiscard]] float coverage_of_emitter(const EmissiveTriangle& emitter, const ShadingMaterial& material,
                                          const Vec2f& at) const;

  // guided.hpp
  void find_cells(std::size_t count);
  void mix_densities(std::size_t count, const LightSample* lights, bool bounces);

  // scatter.hpp
  void scatter_chunk(int vertex, const PathBatch& paths, std::size_t count, const std::uint16_t* active,
                     std::size_t active_count);
  void take_light_sample(int vertex, std::size_t i, const LightSample& light, const PathBatch& paths);
  void take_bsdf_sample(int vertex, std::size_t i, const PathBatch& paths);

  // light_groups.hpp; out of line, so that they do not grow the loops that seldom need them
  [[gnu::noinline]] void add_to_groups(std::size_t slot, const Vec3f& radiance, int events, LightGroup seen,
                                       const Vec3f& diffuse);
  [[gnu::noinline]] void find_diffuse_shares(const std::uint16_t* active, std::size_t active_count,
                                             const LightSample* lights, bool bounces);
  [[nodiscard]] Vec3f diffuse_share(std::size_t i, const Vec3f& world) const;

  // layers.hpp
  void absorb(int vertex, std::size_t count);
  std::size_t choose_channel(int vertex, std::size_t k);
  [[nodiscard]] std::uint32_t body_after(std::size_t i, const PathBatch& paths, bool through) const;
  void scatter_layers(int vertex, const std::uint16_t* active, std::size_t active_count, const LightSample* lights,
                      bool bounces);

  // shadow.hpp
  void queue_shadow(int vertex, std::size_t slot, std::size_t i, const LightSample& light, const Vec3f& arriving);
  void trace_shadows(int vertex);

  const FrameContext& frame_;
  Workspace& work_;
  KernelCounts& counts_;
  std::size_t next_count_ = 0, shadow_count_ = 0;
};

}  // namespace gazetrace
