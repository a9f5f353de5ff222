// SPDX-License-Identifier: Apache-2.0
// Light from zero to beyond float's range.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "trace/kernel/path_kernel.hpp"

namespace gazetrace::extreme_light_test {
namespace {

using namespace test;

// A white matte floor that fills the picture, seen from above.
Scene floor_scene(double half = 10) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  const auto h = static_cast<float>(half);
  add_mesh(scene, {quad({{{-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h}}}, 0)});
  return scene;
}

Camera above(double height = 2) {
  Camera camera;
  camera.pose = look_at({0, height, 0}, {0, 0, 0}, {0, 0, -1});
  camera.projection.yfov_rad = 20 * kRadPerDeg;
  return camera;
}

TraceSettings one_bounce(LightSampling sampling = LightSampling::mis) {
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  settings.max_bounces = 1;
  settings.light_sampling = sampling;
  return settings;
}

// A sun of 1e6 in one pixel of a black sky. Bilinear interpolation spreads it over a tent of two pixels in each
// direction; the mean of cosine and solid angle over the tent is computed by quadrature in double.
TEST(ExtremeLight, ASunOfAMillionOnABlackSky) {
  constexpr int kWidth = 256, kHeight = 128, kRow = 30, kColumn = 77;
  Scene scene = floor_scene();
  scene.environment.radiance = ImageRgb(kWidth, kHeight, Vec3f{0, 0, 0});
  scene.environment.radiance(kColumn, kRow) = {1e6F, 1e6F, 1e6F};
  double irradiance = 0;
  constexpr int kSteps = 400;
  for (int y = 0; y < kSteps; ++y) {
    // Rows from one above to one below the pixel's centre; the columns' tent has the mean 1/2 over two pixels.
    const double row = kRow - 0.5 + 2.0 * (y + 0.5) / kSteps;
    const double polar = kPi * row / kHeight;
    const double tent = 1 - std::fabs(row - kRow - 0.5);
    irradiance += tent * std::cos(polar) * std::sin(polar) * (2 * kPi / kWidth) * (kPi / kHeight) * 2.0 / kSteps;
  }
  const double expected = 1e6 * irradiance / kPi;
  PathTracer tracer(scene, threads(2));
  std::vector<double> means;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    TraceSettings settings = one_bounce();
    settings.seed = seed;
    const SparseFrame frame = tracer.at_rest().trace(above(), 1, uniform_map(32, 32, 64), settings);
    EXPECT_EQ(frame.stats.non_finite_samples, 0U);
    means.push_back(mean_radiance(frame).y);
  }
  const MeanTest result = t_test(means, expected, 1e-4 * expected);
  EXPECT_GT(result.p_value, sidak(1)) << result.mean << " +- " << result.standard_error << ", expected " << expected;
  EXPECT_LT(result.standard_error, 0.005 * expected) << "too noisy to mean anything";
}

TEST(ExtremeLight, AnAllBlackEnvironmentIsNone) {
  Scene scene = floor_scene();
  const SparseFrame none = PathTracer(scene, threads(1)).at_rest().trace(above(), 1, uniform_map(16, 16, 4), {});
  scene.environment = constant_environment({0, 0, 0});
  for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only}) {
    TraceSettings settings;
    settings.light_sampling = sampling;
    const SparseFrame black =
        PathTracer(scene, threads(1)).at_rest().trace(above(), 1, uniform_map(16, 16, 4), settings);
    EXPECT_EQ(black.stats.non_finite_samples + black.stats.rejected_rays, 0U);
    EXPECT_EQ(black.sum, none.sum);
    EXPECT_EQ(mean_radiance(black).y, 0);
  }
  // An emitter beside it is sampled as if it were alone.
  scene.materials.push_back(diffuse_material({0, 0, 0}, {1, 1, 1}));
  add_mesh(scene, {quad({{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}}, 1)});
  const SparseFrame lamp = PathTracer(scene, threads(1)).at_rest().trace(above(), 1, uniform_map(16, 16, 16), {});
  scene.environment = {};
  const SparseFrame alone = PathTracer(scene, threads(1)).at_rest().trace(above(), 1, uniform_map(16, 16, 16), {});
  EXPECT_GT(mean_radiance(lamp).y, 0);
  EXPECT_EQ(lamp.sum, alone.sum);
}

// Weights over float's whole range, compared with the same formula in long double, whose range is far larger.
TEST(ExtremeLight, MisWeightsHoldOverTheWholeRangeOfFloats) {
  double worst = 0;
  for (int i = -37; i <= 38; ++i) {
    for (int j = -37; j <= 38; ++j) {
      for (const double digit : {1.0, 1.7, 3.3}) {
        const auto p = static_cast<float>(std::min(std::pow(10.0, i), 3.4e38));
        const auto q = static_cast<float>(std::min(digit * std::pow(10.0, j), 3.4e38));
        const long double pl = p, ql = q;
        const long double exact = pl * pl / (pl * pl + ql * ql);
        const float weight = power_heuristic(p, q);
        ASSERT_TRUE(std::isfinite(weight)) << p << ' ' << q;
        if (exact > 1e-37L) {
          const auto error = static_cast<double>(std::fabs(static_cast<long double>(weight) - exact) / exact);
          worst = std::max(worst, error);
          EXPECT_LT(error, 4e-7) << p << ' ' << q;
        } else {
          EXPECT_LT(weight, 1.1e-37F);
        }
        // The two weights sum to 1, so no light is lost.
        EXPECT_NEAR(static_cast<double>(weight) + static_cast<double>(power_heuristic(q, p)), 1, 2e-7) << p << ' ' << q;
      }
    }
  }
  std::printf("largest relative error of a weight above 1e-37: %.2g\n", worst);
}

// An emitter's radiance over float's whole range: divided by it, the picture is always the same.
TEST(ExtremeLight, EmissionFrom1eMinus30To1e30) {
  std::array<double, 3> reference{};
  for (const double emission : {1.0, 1e-30, 1e-20, 1e-10, 1e10, 1e20, 1e30}) {
    for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only}) {
      Scene scene = floor_scene();
      const auto e = static_cast<float>(emission);
      scene.materials.push_back(diffuse_material({0.5F, 0.5F, 0.5F}, {e, e, e}));
      add_mesh(scene, {quad({{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}}, 1)});
      TraceSettings settings = one_bounce(sampling);
      settings.max_bounces = 4;
      settings.russian_roulette = false;
      const SparseFrame frame =
          PathTracer(scene, threads(2)).at_rest().trace(above(), 1, uniform_map(16, 16, 64), settings);
      EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U) << emission;
      const double relative = mean_radiance(frame).y / static_cast<double>(e);
      double& expected = reference[static_cast<std::size_t>(sampling)];
      expected = emission == 1.0 ? relative : expected;
      EXPECT_GT(expected, 0.001);
      EXPECT_NEAR(relative / expected, 1, 2e-6) << emission << ' ' << static_cast<int>(sampling);
    }
  }
}

// Where the range ends, this is reported.
TEST(ExtremeLight, BeyondFloatsSamplesAreCounted) {
  Scene scene = floor_scene();
  scene.materials.push_back(diffuse_material({0, 0, 0}, {3e38F, 3e38F, 3e38F}));
  add_mesh(scene, {quad({{{-9, 3, -9}, {9, 3, -9}, {9, 3, 9}, {-9, 3, 9}}}, 1)});
  // Light sampling divides by a density below 1, so the estimate exceeds float's range.
  const SparseFrame frame = PathTracer(scene, threads(2))
                                .at_rest()
                                .trace(above(), 1, uniform_map(8, 8, 16), one_bounce(LightSampling::light_only));
  EXPECT_GT(frame.stats.non_finite_samples, 0U);
  EXPECT_FALSE(frame.stats.bad_samples.empty());
}

TEST(ExtremeLight, PunctualLightsOverTheWholeRange) {
  for (const double intensity : {1e-30, 1e-10, 1.0, 1e10, 1e30}) {
    for (const double height : {1e-3, 1.0, 1e3}) {
      Scene scene = floor_scene(1e4);
      PunctualLight light;
      const auto i = static_cast<float>(intensity);
      light.intensity = {i, i, i};
      light.position_m = {0, height, 0};
      scene.lights = {light};
      // The view is so narrow that the light is straight above all of it.
      Camera camera = above(2 * height);
      camera.projection.yfov_rad = 0.01 * kRadPerDeg;
      const SparseFrame frame =
          PathTracer(scene, threads(1)).at_rest().trace(camera, 1, uniform_map(4, 4, 4), one_bounce());
      EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
      const double expected = static_cast<double>(i) / (height * height) / kPi;
      EXPECT_NEAR(mean_radiance(frame).y / expected, 1, 1e-4) << intensity << ' ' << height;
    }
  }
}

// 1e30 W/sr 0.04 mm above the floor are 6e38 W/m^2 on it: more than a float holds.
TEST(ExtremeLight, APunctualLightThatOverflowsIsNotDropped) {
  for (const LightChoice choice : {LightChoice::power, LightChoice::tree}) {
    Scene scene = floor_scene();
    PunctualLight light;
    light.intensity = {1e30F, 1e30F, 1e30F};
    light.position_m = {0, 4e-5F, 0};
    scene.lights = {light};
    TracerOptions options = threads(1);
    options.light_choice = choice;
    Camera camera = above(2);
    camera.projection.yfov_rad = 1e-5 * kRadPerDeg;
    const SparseFrame frame = PathTracer(scene, options).at_rest().trace(camera, 1, uniform_map(4, 4, 4), one_bounce());
    EXPECT_EQ(frame.stats.non_finite_samples, 64U);
    ASSERT_FALSE(frame.stats.bad_samples.empty());
    EXPECT_EQ(frame.stats.bad_samples[0].what, "non-finite radiance");
  }
}

}  // namespace
}  // namespace gazetrace::extreme_light_test
