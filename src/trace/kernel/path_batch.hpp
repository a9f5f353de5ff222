// SPDX-License-Identifier: Apache-2.0
// The state of the paths of a batch. Samples keep their slots; rays and paths are compacted at every bounce.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gazetrace/guides.hpp"
#include "gazetrace/light_groups.hpp"
#include "gazetrace/math.hpp"
#include "trace/guiding/guiding_field.hpp"
#include "trace/kernel/chunk.hpp"
#include "trace/rays/ray_batch.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {

struct SampleBatch {
  BatchArray<std::uint32_t> site;    // index into SamplingMap::sites
  BatchArray<std::uint32_t> sample;  // number within the site
  BatchArray<std::uint8_t> half;     // 0 or 1; 0 unless TraceSettings::halves
  BatchArray<SampleKey> key;
  BatchArray<std::uint32_t> index;  // of the sample's point in the sequence of its key
  BatchArray<float> x, y;           // continuous pixel coordinates from the frame's centre, with the filter's offset
  BatchArray<std::uint16_t> pixel_x, pixel_y;
};

struct RadianceBatch {
  BatchArray<float> r, g, b;
  BatchArray<std::uint8_t> rejected;  // a ray of this sample was rejected
};

// Data of first hits, for guides.
struct GuideBatch {
  BatchArray<float> albedo_r, albedo_g, albedo_b, normal_x, normal_y, normal_z, depth;
  BatchArray<std::uint8_t> hit;
};

// Data of first hits, for the sums per surface.
struct SurfaceBatch {
  BatchArray<float> albedo_r, albedo_g, albedo_b, normal_x, normal_y, normal_z, place_x, place_y, place_z;
  BatchArray<float> shone_r, shone_g, shone_b;  // radiance that the sample sees directly
  BatchArray<SurfaceKind> kind;
  // As the terms of FirstHitSums.
  BatchArray<float> square_shift_px2;
  BatchArray<std::uint8_t> blended;
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

// Packed like the rays that belong to the paths.
struct PathBatch {
  BatchArray<std::uint32_t> slot;
  BatchArray<float> r, g, b;        // throughput
  BatchArray<float> pdf;            // density of the ray's direction, over solid angle
  BatchVec3 lit_point, lit_normal;  // arguments of the last light choice; only where LightSampler::depends_on_place
  BatchArray<std::uint32_t> body;   // the body that the ray is in: index into LayeredMaterials::materials, or kNoId
};

struct ShadowBatch {
  RayBatch rays;
  BatchArray<std::uint32_t> slot;
  BatchArray<float> r, g, b;  // the contribution if nothing is in the way
  BatchVec3 diffuse;          // as LightGroupBatch::diffuse, of this contribution
};

// The radiance of each sample by LightGroup. Only with TraceSettings::light_groups.
struct LightGroupBatch {
  std::array<BatchVec3, kLightGroups> radiance;
  BatchVec3 diffuse;  // of what the path's next contributions are, the share that the first surface's diffuse lobe has
};

// Of a training path; so memory is bounded whatever TraceSettings::max_bounces is.
inline constexpr int kRecordedBounces = 8;

// A bounce of a training path, until the path is finished.
struct BounceFound {
  TrainingRecord record;
  float throughput = 0;    // luminance, after the bounce
  float shone_before = 0;  // luminance of the sample without what the bounce finds
  std::uint32_t slot = 0;
};

// One per thread, of about 0.5 MiB.
struct Workspace {
  SampleBatch samples;
  RadianceBatch radiance;
  GuideBatch guides;
  SurfaceBatch surfaces;
  LightGroupBatch groups;
  std::array<RayBatch, 2> rays;
  std::array<PathBatch, 2> paths;
  HitBatch hits;
  ShadowBatch shadows;
  BatchArray<std::uint8_t> occluded;
  ChunkHits chunk;
  std::vector<BounceFound> bounces;  // only with FrameContext::records_bounces
};

}  // namespace gazetrace
