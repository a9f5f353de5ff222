// SPDX-License-Identifier: Apache-2.0
// Parts of the samples, added up in any order, equal the whole bit for bit.
#include <gtest/gtest.h>

#include <vector>

#include "gazetrace/reconstruct.hpp"
#include "render/tracer_scenes.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace {
namespace {

using namespace test;

Scene room() {
  Scene scene;
  scene.materials = {diffuse_material({0.8F, 0.7F, 0.6F}), diffuse_material({0.2F, 0.5F, 0.8F})};
  scene.materials[1].metallic = 0.6F;
  scene.materials[1].roughness = 0.2F;
  scene.environment = builtin_sky();
  add_mesh(scene, {quad({{{-4, -1, -4}, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}}}, 0),
                   quad({{{-4, -1, -4}, {4, -1, -4}, {4, 4, -4}, {-4, 4, -4}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1));
  return scene;
}

const Camera kCamera = camera_at({1, 1, 4}, {0, 0, 0});

// Regions of 40, 20 and 10 samples a site; with a budget, counts that are rounded.
SamplingMap map_of(bool budget) {
  FoveationSettings settings;
  settings.region_samples = {40, 20, 10};
  settings.region_angles_deg = {12, 30};
  if (budget) {
    settings.budget_spp = 3.7;
  }
  return make_sampling_map(settings, view_of_perspective(50 * kRadPerDeg, 72, 48), Vec3d{0.1, 0.05, -1});
}

SparseFrame traced(PathTracer& tracer, const SamplingMap& map, const SampleRange& range) {
  TraceSettings settings;
  settings.guides = true;
  settings.samples = range;
  return tracer.at_rest().trace(kCamera, 3, map, settings);
}

void expect_same_bits(const SparseFrame& a, const SparseFrame& b, const SamplingMap& map) {
  EXPECT_TRUE(same_samples(a, b, map));
  ASSERT_EQ(a.guides.size(), b.guides.size());
  for (std::size_t i = 0; i < a.guides.size(); ++i) {
    ASSERT_EQ(a.guides[i].albedo, b.guides[i].albedo) << i;
    ASSERT_EQ(a.guides[i].normal, b.guides[i].normal) << i;
    ASSERT_EQ(a.guides[i].depth_m, b.guides[i].depth_m) << i;
    ASSERT_EQ(a.guides[i].hits, b.guides[i].hits) << i;
  }
}

TEST(SampleRange, AnySplitInAnyOrderIsTheWhole) {
  const Scene scene = room();
  PathTracer one(scene, threads(1));
  PathTracer two(scene, threads(2));
  constexpr std::uint32_t kAll = 4000;  // more than any site has
  const std::vector<std::vector<SampleRange>> splits{
      {{0, kAll}}, {{16, kAll}, {0, 16}}, {{7, 8}, {8, kAll}, {0, 7}}, {{30, kAll}, {0, 11}, {11, 30}}};
  for (const bool budget : {false, true}) {
    const SamplingMap map = map_of(budget);
    const SparseFrame whole = traced(one, map, {0, kAll});
    for (const std::vector<SampleRange>& split : splits) {
      SampleSums sums = traced(two, map, split.front()).unrounded;
      for (std::size_t i = 1; i < split.size(); ++i) {
        add_sums(traced(two, map, split[i]).unrounded, sums);
      }
      expect_same_bits(sparse_frame_of(sums, map), whole, map);
    }
  }
}

// Without a range, rays are traced in packets; all but those that graze an edge hit the same surfaces.
TEST(SampleRange, TheWholeIsWhatIsTracedWithoutARange) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = map_of(false);
  const SparseFrame whole = traced(tracer, map, {0, 40});
  const SparseFrame plain = tracer.at_rest().trace(kCamera, 3, map, {});
  EXPECT_TRUE(plain.unrounded.sites.empty());
  EXPECT_EQ(plain.count, whole.count);
  std::size_t different = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    different += plain.sum[i] == whole.sum[i] ? 0 : 1;
  }
  EXPECT_LE(different, map.sites.size() / 1000);
}

TEST(SampleRange, APartHasItsOwnSamplesOnly) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = map_of(false);
  const SparseFrame part = traced(tracer, map, {8, 25});
  std::uint64_t samples = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const std::uint32_t expected = std::min(map.sites[i].samples, 25U) - std::min(map.sites[i].samples, 8U);
    EXPECT_EQ(part.count[i], expected);
    samples += expected;
  }
  EXPECT_EQ(part.stats.samples, samples);
}

}  // namespace
}  // namespace gazetrace
