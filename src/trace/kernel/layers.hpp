// SPDX-License-Identifier: Apache-2.0
// Hits on materials with extensions are computed one by one, apart from the lanes of all others. For bodies that
// transmit light:
//   - A path knows the body that it is in from the last surface that it crossed, and loses light on the way
//     (lobes/volume.hpp). A path that begins inside a body finds it at the surface through which it leaves. A body
//     inside another one ends the outer one.
//   - Where the index of refraction depends on colour, the path continues with one channel, chosen once, at three times
//     the weight. A path that already has only one channel keeps it.
#pragma once

#include <array>
#include <cmath>

#include "material/layered_bsdf.hpp"
#include "material/lobes/volume.hpp"
#include "trace/kernel/layered_hit.hpp"
#include "trace/kernel/path_kernel.hpp"

namespace gazetrace {

// Applies absorption on the way to each hit of the chunk to the throughput.
template <bool kLayers>
inline void PathKernel<kLayers>::absorb(int vertex, std::size_t count) {
  const ChunkHits& chunk = work_.chunk;
  PathBatch& paths = work_.paths[static_cast<std::size_t>(vertex & 1)];
  const LayeredMaterials& layered = frame_.scene->layered;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = chunk.path[i];
    const LayeredMaterial* body = paths.body[k] == kNoId ? nullptr : &layered.materials[paths.body[k]];
    if (body == nullptr && chunk.side[i] < 0) {
      const LayeredMaterial* own = layered.of(chunk.material[i]);
      body = own != nullptr && own->solid ? own : nullptr;
    }
    if (body != nullptr) {
      const Vec3f left = transmittance(body->absorption_per_m, chunk.t[i]);
      paths.r[k] *= left.x;
      paths.g[k] *= left.y;
      paths.b[k] *= left.z;
    }
  }
}

// The channel whose index of refraction a path uses; the throughput of the other channels is set to 0.
template <bool kLayers>
inline std::size_t PathKernel<kLayers>::choose_channel(int vertex, std::size_t k) {
  PathBatch& paths = work_.paths[static_cast<std::size_t>(vertex & 1)];
  const std::array<float*, 3> throughput{&paths.r[k], &paths.g[k], &paths.b[k]};
  std::size_t alive = 0;
  std::size_t last = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    alive += *throughput[c] > 0 ? 1 : 0;
    last = *throughput[c] > 0 ? c : last;
  }
  if (alive <= 1) {
    return last;
  }
  const std::size_t slot = paths.slot[k];
  const float u =
      sample_1d(work_.samples.key[slot], work_.samples.index[slot], dimension_of(0, BounceDimension::channel));
  const auto chosen = std::min(static_cast<std::size_t>(3.0F * u), std::size_t{2});
  for (std::size_t c = 0; c < 3; ++c) {
    *throughput[c] *= c == chosen ? 3.0F : 0.0F;
  }
  return chosen;
}

// The body that a ray is in after it leaves hit i, on the other side of the surface or not.
template <bool kLayers>
inline std::uint32_t PathKernel<kLayers>::body_after(std::size_t i, const PathBatch& paths, bool through) const {
  const ChunkHits& chunk = work_.chunk;
  const std::uint32_t own = frame_.scene->layered.index[chunk.material[i]];
  const std::uint32_t before = paths.body[chunk.path[i]];
  if (own == LayeredMaterials::kNoLayers || !frame_.scene->layered.materials[own].solid) {
    return before;
  }
  const bool inside = (chunk.side[i] < 0) != through;
  return inside ? own : (through ? kNoId : before);
}

// Does what evaluate_lanes does, for those lanes of `active` whose material has layers.
template <bool kLayers>
inline void PathKernel<kLayers>::scatter_layers(int vertex, const std::uint16_t* active, std::size_t active_count,
                                                const LightSample* lights, bool bounces) {
  ChunkHits& chunk = work_.chunk;
  const RenderScene& scene = *frame_.scene;
  for (std::size_t a = 0; a < active_count; ++a) {
    const std::size_t i = active[a];
    const LayeredMaterial* material = scene.layered.of(chunk.material[i]);
    if (material == nullptr) {
      continue;
    }
    const std::size_t channel = material->layers.dispersion ? choose_channel(vertex, chunk.path[i]) : 0;
    const LayeredHit hit = read_layered_hit(scene, chunk, i, *material, channel);
    const Vec3f geometric = chunk.geometric.get(i);
    const LayeredBsdf bsdf(hit.surface, hit.frame.to_local(-chunk.direction.get(i)), frame_.settings.diffuse);
    // The shading normal and the geometric normal must agree on the side of a direction.
    const auto agree = [&](const Vec3f& local, const Vec3f& world) { return local.z * dot(world, geometric) > 0; };
    if (lights != nullptr) {
      const Vec3f local = hit.frame.to_local(lights[i].direction);
      BsdfEval eval{{0, 0, 0}, 0};
      if (lights[i].valid && agree(local, lights[i].direction)) {
        eval = bsdf.evaluate(local);
      }
      chunk.light_f_cos.set(i, eval.f_cos);
      chunk.light_pdf[i] = eval.pdf;
    }
    if (bounces) {
      const BsdfSample sample = bsdf.sample(chunk.random.get(i), chunk.random_lobe[i]);
      const Vec3f world = normalize(hit.frame.to_world(sample.direction));
      chunk.next.set(i, world);
      chunk.next_weight.set(i, sample.weight);
      chunk.next_pdf[i] = sample.pdf;
      chunk.next_good[i] = sample.valid && agree(sample.direction, world) ? 1.0F : 0.0F;
    }
  }
}

}  // namespace gazetrace
