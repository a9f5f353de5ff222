// SPDX-License-Identifier: Apache-2.0
// Scenes whose radiance is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"

namespace gazetrace::tracer_light_test {
namespace {

using namespace test;

TEST(TracerLight, AConstantEnvironmentSeenDirectlyIsExact) {
  Scene scene;
  scene.materials.emplace_back();
  scene.environment = constant_environment({0.25F, 0.5F, 2.0F});
  PathTracer tracer(scene, threads(1));
  const SparseFrame frame = tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}), 1, uniform_map(16, 8, 4), {});
  ASSERT_EQ(frame.sum.size(), 128U);
  for (std::size_t i = 0; i < frame.sum.size(); ++i) {
    EXPECT_EQ(frame.count[i], 4U);
    EXPECT_EQ(frame.sum[i], (Vec3f{1.0F, 2.0F, 8.0F}));
  }
  EXPECT_EQ(frame.stats.samples, 512U);
  EXPECT_EQ(frame.stats.rays_primary, 512U);
  EXPECT_EQ(frame.stats.rays_bounce + frame.stats.rays_shadow, 0U);
  EXPECT_EQ(frame.stats.rejected_rays, 0U);
  EXPECT_EQ(frame.stats.non_finite_samples, 0U);
}

// Inside a box whose white walls emit 1 and reflect everything, every scattering event adds the same radiance again:
// L = 1 + max_bounces, whatever the lobes, the light sampling and the place.
TEST(TracerLight, AWhiteGlowingBoxAddsOneForEveryBounce) {
  for (const DiffuseModel diffuse : {DiffuseModel::burley, DiffuseModel::lambert}) {
    Scene scene;
    scene.materials.push_back(diffuse_material({1, 1, 1}, {1, 1, 1}));
    add_mesh(scene, box(1.5F, true, 0));
    PathTracer tracer(scene, threads(2));
    const SamplingMap map = uniform_map(16, 16, 256);
    for (const int bounces : {0, 1, 5}) {
      TraceSettings settings;
      settings.diffuse = diffuse;
      settings.max_bounces = bounces;
      settings.russian_roulette = false;
      settings.light_sampling = LightSampling::bsdf_only;
      const Vec3d mean =
          mean_radiance(tracer.at_rest().trace(camera_at({0.2, 0.3, 0.4}, {1, 0.5, -1}), 1, map, settings));
      // The albedo tables' interpolation error (2e-3 an event, bsdf_furnace_test) is all that is left.
      EXPECT_NEAR(mean.y, 1 + bounces, 2e-3 * bounces * (bounces + 1) / 2 + 1e-6) << bounces;
      settings.light_sampling = LightSampling::mis;
      const Vec3d mixed =
          mean_radiance(tracer.at_rest().trace(camera_at({0.2, 0.3, 0.4}, {1, 0.5, -1}), 1, map, settings));
      EXPECT_NEAR(mixed.y, 1 + bounces, 0.01 * bounces + 1e-6) << bounces;
    }
  }
}

// Inside a closed box whose ideally diffuse walls emit 1 and reflect a, L = 1 + a + a^2 + ... = 1 / (1 - a).
TEST(TracerLight, AGlowingLambertianBoxIsTheGeometricSeries) {
  for (const float albedo : {0.2F, 0.5F, 0.8F}) {
    Scene scene;
    scene.materials.push_back(diffuse_material({albedo, albedo, albedo}, {1, 1, 1}));
    add_mesh(scene, box(1.5F, true, 0));
    PathTracer tracer(scene, threads(2));
    const Camera camera = camera_at({0.2, 0.3, 0.4}, {1, 0.5, -1});
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    settings.max_bounces = 96;  // 0.8^97 < 4e-10
    settings.russian_roulette = false;
    const double expected = 1.0 / (1.0 - static_cast<double>(albedo));

    // Cosine sampling of a cosine lobe has no variance here: exact up to float sums.
    settings.light_sampling = LightSampling::bsdf_only;
    const SamplingMap one = uniform_map(8, 8, 16);
    EXPECT_NEAR(mean_radiance(tracer.at_rest().trace(camera, 1, one, settings)).y, expected, 2e-5 * expected) << albedo;

    settings.light_sampling = LightSampling::mis;
    settings.russian_roulette = true;
    Repeats repeats;
    for (std::uint64_t seed = 0; seed < 32; ++seed) {
      settings.seed = seed;
      repeats.means.push_back(mean_radiance(tracer.at_rest().trace(camera, 1, one, settings)).y);
    }
    EXPECT_LT(std::fabs(repeats.mean() - expected), kCriticalT * std::sqrt(repeats.variance_of_mean())) << albedo;
    EXPECT_LT(std::sqrt(repeats.variance_of_mean()), 0.01 * expected) << albedo;
  }
}

// Emission of 1e30 and 1e-30 (what loading lets through): the series holds to float's precision, and nothing overflows
// or vanishes. It ends where radiance does: at 3.4e38 over the number of samples above, at 1.2e-38 (smaller floats are
// flushed to zero) below; the sum of squares saturates from a radiance of 1.8e19 on and is zero below about 1e-19.
TEST(TracerLight, ExtremeEmissionKeepsTheSeries) {
  for (const float emission : {1e30F, 1e-30F}) {
    Scene scene;
    scene.materials.push_back(diffuse_material({0.5F, 0.5F, 0.5F}, {emission, emission, emission}));
    add_mesh(scene, box(1.5F, true, 0));
    for (const LightChoice choice : {LightChoice::power, LightChoice::tree}) {
      TracerOptions options = threads(2);
      options.light_choice = choice;
      PathTracer tracer(scene, options);
      const Camera camera = camera_at({0.2, 0.3, 0.4}, {1, 0.5, -1});
      TraceSettings settings;
      settings.diffuse = DiffuseModel::matte;
      settings.max_bounces = 40;
      settings.russian_roulette = false;
      const double expected = static_cast<double>(emission) / (1.0 - 0.5);
      settings.light_sampling = LightSampling::bsdf_only;
      EXPECT_NEAR(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 4), settings)).y / expected, 1,
                  2e-5);
      for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only}) {
        settings.light_sampling = sampling;
        Repeats repeats;
        for (std::uint64_t seed = 0; seed < 32; ++seed) {
          settings.seed = seed;
          const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 16), settings);
          EXPECT_EQ(frame.stats.non_finite_samples, 0U);
          for (std::size_t i = 0; i < frame.sum.size(); ++i) {
            ASSERT_TRUE(std::isfinite(frame.sum[i].y) && frame.sum[i].y > 0);
            ASSERT_TRUE(std::isfinite(frame.sum_square_luminance[i]));
          }
          repeats.means.push_back(mean_radiance(frame).y / expected);
        }
        EXPECT_LT(std::fabs(repeats.mean() - 1), kCriticalT * std::sqrt(repeats.variance_of_mean()) + 2e-5)
            << emission << " " << repeats.mean();
        EXPECT_LT(std::sqrt(repeats.variance_of_mean()), 0.01) << "as above, where the series itself is tested";
      }
    }
  }
}

// The same box: after v events a path finds a^v, which clamping bounds from the second event on.
TEST(TracerLight, ClampingBoundsIndirectLightOnly) {
  for (const float albedo : {0.5F, 0.8F}) {
    Scene scene;
    scene.materials.push_back(diffuse_material({albedo, albedo, albedo}, {1, 1, 1}));
    add_mesh(scene, box(1.5F, true, 0));
    PathTracer tracer(scene, threads(2));
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    settings.light_sampling = LightSampling::bsdf_only;
    settings.max_bounces = 20;
    settings.russian_roulette = false;
    for (const float limit : {0.0F, 1e-3F, 0.1F, 0.3F, 0.6F, 10.0F}) {
      settings.clamp_indirect = static_cast<double>(limit);
      const double bound = limit > 0 ? static_cast<double>(limit) : 2.0;
      double expected = 0;
      for (int v = 0; v <= settings.max_bounces; ++v) {
        const double found = std::pow(static_cast<double>(albedo), v);
        expected += v < 2 ? found : std::min(found, bound);
      }
      const Vec3d mean = mean_radiance(
          tracer.at_rest().trace(camera_at({0.2, 0.3, 0.4}, {1, 0.5, -1}), 1, uniform_map(8, 8, 4), settings));
      EXPECT_NEAR(mean.y, expected, 2e-5 * expected) << albedo << " " << limit;
    }
    // Light samples: with one bounce nothing is indirect, with two the second event's is.
    settings.light_sampling = LightSampling::light_only;
    settings.clamp_indirect = 1e-9;
    settings.max_bounces = 1;
    const SamplingMap map = uniform_map(16, 16, 256);
    const Camera camera = camera_at({0.2, 0.3, 0.4}, {1, 0.5, -1});
    const double direct = mean_radiance(tracer.at_rest().trace(camera, 1, map, settings)).y;
    EXPECT_NEAR(direct, 1 + static_cast<double>(albedo), 0.01);
    settings.max_bounces = 2;
    EXPECT_NEAR(mean_radiance(tracer.at_rest().trace(camera, 1, map, settings)).y, direct, 1e-6);
  }
}

}  // namespace
}  // namespace gazetrace::tracer_light_test
