// SPDX-License-Identifier: Apache-2.0
// State of the paths of a batch. Samples keep their slot; rays and paths are packed anew at every bounce.
#pragma once

#include <array>
#include <cstdint>

#include "gazetrace/guides.hpp"
#include "gazetrace/math.hpp"
#include "trace/kernel/chunk.hpp"
#include "trace/rays/ray_batch.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {

struct SampleBatch {
  BatchArray<std::uint32_t> site;    // index into SamplingMap::sites
  BatchArray<std::uint32_t> sample;  // within the site
  BatchArray<SampleKey> key;
  BatchArray<float> x, y;  // continuous pixel coordinates from the frame's centre, filter included
  BatchArray<std::uint16_t> pixel_x, pixel_y;
};

struct RadianceBatch {
  BatchArray<float> r, g, b;
  BatchArray<std::uint8_t> rejected;  // a ray of this sample was refused
};

// First hits, for the guides.
struct GuideBatch {
  BatchArray<float> albedo_r, albedo_g, albedo_b, normal_x, normal_y, normal_z, depth;
  BatchArray<std::uint8_t> hit;
};

// First hits, for sums per surface.
struct SurfaceBatch {
  BatchArray<float> albedo_r, albedo_g, albedo_b, normal_x, normal_y, normal_z, place_x, place_y, place_z;
  BatchArray<float> shone_r, shone_g, shone_b;  // what the sample sees directly
  BatchArray<SurfaceKind> kind;
};

struct BatchVec3 {
  BatchArray<float> x, y, z;
  [[nodiscard]] Vec3f get(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3f& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

// Packed like the rays that belong to it.
struct PathBatch {
  BatchArray<std::uint32_t> slot;
  BatchArray<float> r, g, b;  // throughput
  BatchArray<float> pdf;      // of the ray's direction, over solid angle
  BatchArray<float> cone_width, cone_spread;
  BatchVec3 lit_point, lit_normal;  // that lights were chosen with before it left; LightSampler::depends_on_place only
  BatchArray<std::uint32_t> body;   // that the ray is in: index into LayeredMaterials::materials, kNoId: none
};

struct ShadowBatch {
  RayBatch rays;
  BatchArray<std::uint32_t> slot;
  BatchArray<float> r, g, b;  // what arrives if nothing is in the way
};

// One a thread, about 0.5 MiB.
struct Workspace {
  SampleBatch samples;
  RadianceBatch radiance;
  GuideBatch guides;
  SurfaceBatch surfaces;
  std::array<RayBatch, 2> rays;
  std::array<PathBatch, 2> paths;
  HitBatch hits;
  ShadowBatch shadows;
  BatchArray<std::uint8_t> occluded;
  ChunkHits chunk;
};

}  // namespace gazetrace
