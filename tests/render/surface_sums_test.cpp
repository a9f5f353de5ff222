// SPDX-License-Identifier: Apache-2.0
// Sums per surface as the tracer makes them, and the guided filter on traced frames.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "render/tracer_scenes.hpp"
#include "support/picture_evidence.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace {
namespace {

using namespace test;

constexpr int kWidth = 96;
constexpr int kHeight = 64;

// A floor, a box on it and a lamp in view, under an even sky.
Scene lit_scene() {
  Scene scene;
  scene.materials = {diffuse_material({0.7F, 0.5F, 0.3F}), diffuse_material({0.2F, 0.4F, 0.8F}),
                     diffuse_material({0.5F, 0.5F, 0.5F}, {20, 10, 5})};
  add_mesh(scene, {quad({{{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1), make_affine({0, 0.7, 0}, {0, 0.2, 0, 0.98}, {1, 1, 1}));
  add_mesh(scene, {quad({{{-2, 1, -2}, {-1, 1, -2}, {-1, 2, -2}, {-2, 2, -2}}}, 2)});
  scene.environment = constant_environment({0.4F, 0.5F, 0.6F});
  return scene;
}

const Camera kCamera = camera_at({2, 2, 5}, {-0.5, 0.8, 0});

// Single pixels of 32 samples in the middle, blocks of 2 and 4 around.
SamplingMap foveated_map() {
  FoveationSettings settings;
  settings.region_angles_deg = {10, 24};
  return make_sampling_map(settings, view_of_perspective(50 * kRadPerDeg, kWidth, kHeight), Vec3d{0, 0, -1});
}

TraceSettings with_surfaces() {
  TraceSettings settings;
  settings.surfaces = true;
  return settings;
}

TraceSettings with_halves() {
  return Reconstruction({"guided", {}}).trace_settings({});
}

TEST(SurfaceSums, AskingForThemChangesNoBitOfTheSums) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  const SparseFrame plain = tracer.at_rest().trace(kCamera, 0, map, {});
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, with_surfaces());
  EXPECT_TRUE(same_samples(plain, sparse, map));
  EXPECT_EQ(plain.sum_square_luminance, sparse.sum_square_luminance);
  EXPECT_EQ(plain.count, sparse.count);
  EXPECT_TRUE(plain.surfaces.empty() && plain.first_surface.empty());
}

// What a site's samples see shining and what its surfaces reflect is all of its light. The first is known where a path
// tracer of no bounces sees the same samples.
TEST(SurfaceSums, ShiningAndReflectedLightAreTheWholeSum) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, with_surfaces());
  TraceSettings only_seen;
  only_seen.max_bounces = 0;
  const SparseFrame seen = tracer.at_rest().trace(kCamera, 0, map, only_seen);
  ASSERT_EQ(sparse.first_surface.size(), map.sites.size() + 1);
  ASSERT_EQ(sparse.first_surface.back(), sparse.surfaces.size());
  std::size_t several = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    Vec3d sum = to_double(seen.sum[i]);
    std::uint32_t count = 0;
    for (std::size_t s = sparse.first_surface[i]; s < sparse.first_surface[i + 1]; ++s) {
      const SurfaceSums& surface = sparse.surfaces[s];
      sum += to_double(surface.reflected);
      count += surface.count;
      EXPECT_GT(surface.count, 0U);
      EXPECT_LE(dot(surface.normal, surface.normal), 1.0001F * static_cast<float>(surface.count * surface.count));
    }
    several += sparse.first_surface[i + 1] - sparse.first_surface[i] > 1 ? 1 : 0;
    EXPECT_LE(count, sparse.count[i]);
    const double tolerance = 1e-5 * static_cast<double>(sparse.sum[i].x) + 1e-6;
    EXPECT_NEAR(sum.x, static_cast<double>(sparse.sum[i].x), tolerance) << i;
    EXPECT_NEAR(sum.z, static_cast<double>(sparse.sum[i].z), tolerance) << i;
  }
  EXPECT_GT(several, 20U);  // edges of box, lamp and floor
}

// The tracer and the filters must agree on which single pixels are smoothed: by expectations, which are certain.
TEST(SurfaceSums, SinglePixelsHaveThemWhereFewerThanEnoughSamplesAreExpected) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  FoveationSettings foveation;
  foveation.falloff = "linear";
  foveation.uniform_spp = 20;
  const SamplingMap map =
      make_sampling_map(foveation, view_of_perspective(50 * kRadPerDeg, kWidth, kHeight), Vec3d{0, 0, -1});
  TraceSettings settings = with_surfaces();
  settings.guides = true;
  settings.pass_through_samples = 16;
  settings.max_bounces = 1;
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, settings);
  int rounded_up = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const bool has = sparse.first_surface[i] != sparse.first_surface[i + 1];
    if (map.regions[map.sites[i].region].block_px == 1 && sparse.guides[i].hits > 0) {
      ASSERT_EQ(has, map.expected(i) < 16) << i;
      rounded_up += map.expected(i) < 16 && map.sites[i].samples >= 16 ? 1 : 0;
    }
  }
  EXPECT_GT(rounded_up, 10);
}

// Over 1000 seeds, the variance of the sites' means, and the mean square of half the difference of their halves.
TEST(SurfaceSums, HalvesTellTheVarianceOfTheMeanOfAllSamples) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  TraceSettings settings = with_halves();
  constexpr int kSeeds = 1000;
  struct Site {
    double sum = 0, square = 0, difference = 0, difference_square = 0;
  };
  std::vector<Site> sites(map.sites.size());
  for (int seed = 0; seed < kSeeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, settings);
    ASSERT_EQ(sparse.half_difference.size(), map.sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const double mean = luminance(to_double(sparse.sum[i])) / sparse.count[i];
      const auto difference = static_cast<double>(sparse.half_difference[i]);
      sites[i].sum += mean;
      sites[i].square += mean * mean;
      sites[i].difference += difference;
      sites[i].difference_square += difference * difference;
    }
  }
  double variance = 0;
  double replica = 0;
  double bias = 0;
  for (const Site& site : sites) {
    variance += (site.square - site.sum * site.sum / kSeeds) / (kSeeds - 1);
    replica += site.difference_square / kSeeds;
    bias += site.difference / kSeeds;
  }
  // A few dozen sites on the lamp's edge have most of the variance: the relative standard error of both sums is then
  // about sqrt(2 / (1000 seeds times 10 sites)), 1.4 %.
  EXPECT_NEAR(replica / variance, 1, 0.05);
  const double of_bias = std::sqrt(replica / kSeeds);
  EXPECT_NEAR(bias, 0, 4 * of_bias);
}

TEST(SurfaceSums, SameBitsForAnyThreadCount) {
  const Scene scene = lit_scene();
  const SamplingMap map = foveated_map();
  PathTracer one(scene, threads(1));
  PathTracer two(scene, threads(2));
  const GuideSettings settings{.edge_rays = 3};
  const Guides guides_one = one.at_rest().guides(kCamera, kWidth, kHeight, settings);
  const Guides guides_two = two.at_rest().guides(kCamera, kWidth, kHeight, settings);
  EXPECT_GT(guides_one.edge_rays.size(), 300U);
  const Frame a = reconstruct(one.at_rest().trace(kCamera, 0, map, with_halves()), map, "guided", 1, &guides_one);
  const Frame b = reconstruct(two.at_rest().trace(kCamera, 0, map, with_halves()), map, "guided", 2, &guides_two);
  EXPECT_TRUE(same_picture(a.radiance, b.radiance));
  EXPECT_EQ(a.variance, b.variance);
}

// Against many samples: the fovea's pixels and the others are nearer to the truth than the linear filter's, and the
// mean of the frame is within a per cent of the truth's.
TEST(GuidedFilter, IsNearerToManySamplesThanLinear) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  TraceSettings other;
  other.seed = 99;
  const SamplingMap full = uniform_map(kWidth, kHeight, 512);
  const Frame truth = reconstruct(tracer.at_rest().trace(kCamera, 0, full, other), full, "none");
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, with_halves());
  const Guides guides = tracer.at_rest().guides(kCamera, kWidth, kHeight, {.edge_rays = 4});
  const Frame linear = reconstruct(sparse, map, "linear");
  const Frame guided = reconstruct(sparse, map, "guided", 0, &guides);
  std::array<double, 2> linear_error{};  // of blocks, and of the fovea's pixels
  std::array<double, 2> guided_error{};
  double truth_sum = 0;
  double guided_sum = 0;
  for (std::size_t i = 0; i < truth.radiance.pixels.size(); ++i) {
    const std::size_t where = map.regions[map.region.pixels[i]].block_px == 1 ? 1 : 0;
    const Vec3d t = to_double(truth.radiance.pixels[i]);
    const Vec3d l = to_double(linear.radiance.pixels[i]) - t;
    const Vec3d g = to_double(guided.radiance.pixels[i]) - t;
    linear_error[where] += dot(l, l) / (0.01 + dot(t, t));
    guided_error[where] += dot(g, g) / (0.01 + dot(t, t));
    truth_sum += t.y;
    guided_sum += static_cast<double>(guided.radiance.pixels[i].y);
  }
  EXPECT_LT(guided_error[0], 0.25 * linear_error[0]);
  EXPECT_LT(guided_error[1], linear_error[1]);
  EXPECT_NEAR(guided_sum / truth_sum, 1, 0.01);
}

}  // namespace
}  // namespace gazetrace
