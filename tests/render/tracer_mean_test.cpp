// SPDX-License-Identifier: Apache-2.0
// Estimators that must agree in the mean: ways to find light, ways to spread samples.
#include <gtest/gtest.h>

#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"

namespace gazetrace::tracer_mean_test {
namespace {

using namespace test;

constexpr int kRepeats = 32;

Repeats repeat(PathTracer& tracer, const Camera& camera, const SamplingMap& map, TraceSettings settings) {
  Repeats result;
  for (int i = 0; i < kRepeats; ++i) {
    settings.seed = static_cast<std::uint64_t>(i + 1);
    result.means.push_back(mean_radiance(tracer.at_rest().trace(camera, 1, map, settings)).y);
  }
  return result;
}

Scene corner(bool area_light, bool sky) {
  Scene scene;
  scene.materials.push_back(diffuse_material({0.7F, 0.6F, 0.5F}));
  scene.materials.push_back(diffuse_material({0.9F, 0.7F, 0.4F}));
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0.4F;
  add_mesh(scene, {quad({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, 0),
                   quad({{{-3, 0, -2}, {3, 0, -2}, {3, 4, -2}, {-3, 4, -2}}}, 0)});
  add_mesh(scene, box(0.5F, false, 1), make_affine({0.3, 0.5, 0}, {0, 0.3, 0, 0.954}, {1, 1, 1}));
  if (area_light) {
    scene.materials.push_back(diffuse_material({0.5F, 0.5F, 0.5F}, {4, 4, 4}));
    add_mesh(scene, {quad({{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}}, 2)});
  }
  if (sky) {
    scene.environment = builtin_sky();
    // A sun, so that a part of the sky stands out.
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        const ImageRgb& picture = scene.environment.radiance;
        scene.environment.radiance(picture.width_px / 2 + x, picture.height_px / 5 + y) = {200, 150, 100};
      }
    }
  }
  return scene;
}

// Varnish, fibres and a sheet that lets light through on what was plain.
Scene with_layers(Scene scene) {
  scene.materials[0].sheen.color = {0.8F, 0.3F, 0.2F};
  scene.materials[0].sheen.roughness = 0.4F;
  scene.materials[0].diffuse_transmission.factor = 0.3F;
  scene.materials[0].double_sided = true;
  scene.materials[1].clearcoat.factor = 0.8F;
  scene.materials[1].clearcoat.roughness = 0.3F;
  scene.materials[1].anisotropy.strength = 0.6F;
  return scene;
}

TEST(TracerMean, MisLightOnlyAndBsdfOnlyAgree) {
  struct Case {
    const char* name;
    bool area_light, sky;
    bool layered = false;
  };
  for (const Case& c : {Case{"area light", true, false}, Case{"sky", false, true}, Case{"both", true, true},
                        Case{"layered materials", true, true, true}}) {
    const Scene scene = c.layered ? with_layers(corner(c.area_light, c.sky)) : corner(c.area_light, c.sky);
    PathTracer tracer(scene, threads(2));
    const Camera camera = camera_at({1.5, 2.0, 5}, {0, 0.8, 0});
    const SamplingMap map = uniform_map(24, 16, 16);
    TraceSettings settings;
    const Repeats mis = repeat(tracer, camera, map, settings);
    settings.light_sampling = LightSampling::light_only;
    const Repeats light = repeat(tracer, camera, map, settings);
    settings.light_sampling = LightSampling::bsdf_only;
    const Repeats bsdf = repeat(tracer, camera, map, settings);
    EXPECT_LT(std::fabs(welch_t(mis, light)), kCriticalT) << c.name << mis.mean() << " " << light.mean();
    EXPECT_LT(std::fabs(welch_t(mis, bsdf)), kCriticalT) << c.name << mis.mean() << " " << bsdf.mean();
    EXPECT_LT(std::sqrt(mis.variance_of_mean()), 0.01 * mis.mean()) << "too noisy to mean anything";
  }
}

// Several dozen lights of every kind, in a mirrored instance too; the lamps hang low, so that rays often find them by
// chance and a wrong density would show in the weights.
Scene corner_with_many_lights() {
  Scene scene = corner(false, false);
  for (const bool double_sided : {false, true}) {
    scene.materials.push_back(diffuse_material({0.5F, 0.5F, 0.5F}, double_sided ? Vec3f{2, 6, 4} : Vec3f{9, 6, 3}));
    scene.materials.back().double_sided = double_sided;
  }
  std::vector<Geometry> lamps;
  for (int i = 0; i < 12; ++i) {
    const float x = -2.5F + 0.45F * static_cast<float>(i);
    const float y = 0.3F + 0.2F * static_cast<float>(i % 3);
    const float z = -1.5F + 0.6F * static_cast<float>(i % 4);
    lamps.push_back(
        quad({{{x, y, z}, {x + 0.4F, y, z}, {x + 0.4F, y + 0.1F, z + 0.4F}, {x, y + 0.1F, z + 0.4F}}}, 2 + i % 2));
  }
  add_mesh(scene, lamps);
  scene.instances.push_back({scene.instances.back().mesh, make_affine({0, 1, 1}, {0, 0, 0, 1}, {-1, 1, 1})});
  for (int i = 0; i < 10; ++i) {
    PunctualLight light;
    light.kind = i % 2 == 0 ? LightKind::point : LightKind::spot;
    light.position_m = {-2 + 0.4F * static_cast<float>(i), 1.5F, 1};
    light.direction = {0.1F, -1, -0.3F};
    light.intensity = {0.02F, 0.03F, 0.04F};
    light.range_m = i % 3 == 0 ? 2.5F : 0;
    scene.lights.push_back(light);
  }
  return scene;
}

TEST(TracerMean, ManyLightsAgreeHoweverTheyAreChosen) {
  const Scene scene = corner_with_many_lights();
  const Camera camera = camera_at({1.5, 2.0, 5}, {0, 0.8, 0});
  const SamplingMap map = uniform_map(24, 16, 64);
  TracerOptions options = threads(2);
  options.light_choice = LightChoice::tree;
  PathTracer tree(scene, options);
  options.light_choice = LightChoice::power;
  PathTracer power(scene, options);
  TraceSettings settings;
  const Repeats mis = repeat(tree, camera, map, settings);
  const Repeats by_power = repeat(power, camera, map, settings);
  settings.light_sampling = LightSampling::light_only;
  const Repeats light = repeat(tree, camera, map, settings);
  settings.light_sampling = LightSampling::bsdf_only;
  const Repeats bsdf = repeat(tree, camera, map, settings);
  EXPECT_LT(std::fabs(welch_t(mis, by_power)), kCriticalT) << mis.mean() << " " << by_power.mean();
  EXPECT_LT(std::fabs(welch_t(mis, light)), kCriticalT) << mis.mean() << " " << light.mean();
  EXPECT_LT(std::fabs(welch_t(mis, bsdf)), kCriticalT) << mis.mean() << " " << bsdf.mean();
  EXPECT_LT(std::sqrt(bsdf.variance_of_mean()), 0.01 * mis.mean()) << "too noisy to mean anything";
  EXPECT_LT(std::sqrt(light.variance_of_mean()), 0.01 * mis.mean()) << "too noisy to mean anything";
}

// Light sampling must see no more of a lamp than a ray that looks for it.
TEST(TracerMean, CutOutAndBlendedLampsShineWithWhatIsThere) {
  struct Case {
    const char* name;
    AlphaMode mode;
    float alpha, expected;
  };
  const Camera camera = camera_at({1.5, 2.0, 5}, {0, 0.8, 0});
  const SamplingMap map = uniform_map(24, 16, 16);
  double whole = 0;
  for (const Case& c : {Case{"whole", AlphaMode::opaque, 1, 1}, Case{"blended", AlphaMode::blend, 0.25F, 0.25F},
                        Case{"kept", AlphaMode::mask, 0.75F, 1}, Case{"cut away", AlphaMode::mask, 0.25F, 0}}) {
    Scene scene = corner(true, false);
    scene.materials[2].alpha_mode = c.mode;
    scene.materials[2].base_color.w = c.alpha;
    PathTracer tracer(scene, threads(2));
    TraceSettings settings;
    settings.max_bounces = 1;  // direct light only: it is proportional to what is there of the lamp
    Repeats light;
    for (const LightSampling mode : {LightSampling::light_only, LightSampling::mis, LightSampling::bsdf_only}) {
      settings.light_sampling = mode;
      const Repeats found = repeat(tracer, camera, map, settings);
      if (mode == LightSampling::light_only) {
        light = found;
        whole = c.mode == AlphaMode::opaque ? found.mean() : whole;
        // The lamp itself is in the picture's light, too; both scale alike.
        EXPECT_NEAR(found.mean(), whole * static_cast<double>(c.expected), 0.03 * whole) << c.name;
      } else if (c.expected > 0) {
        EXPECT_LT(std::fabs(welch_t(found, light)), kCriticalT) << c.name << found.mean() << " " << light.mean();
      } else {
        EXPECT_EQ(found.mean(), 0) << c.name;
      }
    }
  }
}

TEST(TracerMean, RussianRouletteKeepsTheMean) {
  const Scene scene = corner(true, true);
  PathTracer tracer(scene, threads(2));
  const Camera camera = camera_at({1.5, 2.0, 5}, {0, 0.8, 0});
  const SamplingMap map = uniform_map(24, 16, 16);
  TraceSettings settings;
  settings.max_bounces = 8;
  const Repeats all = repeat(tracer, camera, map, settings);
  settings.russian_roulette = true;
  const Repeats some = repeat(tracer, camera, map, settings);
  EXPECT_LT(std::fabs(welch_t(all, some)), kCriticalT) << all.mean() << " " << some.mean();
}

// Sites of n x n pixels, straddling blocks included, against every pixel sampled: the frame's integral is the same.
TEST(TracerMean, AFoveatedFrameHasTheUniformFramesMean) {
  const Scene scene = corner(true, true);
  PathTracer tracer(scene, threads(2));
  const Camera camera = camera_at({1.5, 2.0, 5}, {0, 0.8, 0});
  const auto integral = [](const SparseFrame& frame, const SamplingMap& map) {
    double sum = 0;
    for (std::size_t i = 0; i < frame.sum.size(); ++i) {
      sum += static_cast<double>(frame.sum[i].y) / frame.count[i] * map.sites[i].pixels;
    }
    return sum / (map.width_px * map.height_px);
  };
  FoveationSettings foveated;
  std::get<RegionSampling>(foveated.sampling).eccentricities_deg = {5, 12.5};
  const SamplingMap sparse =
      make_sampling_map(foveated, view_of_perspective(50 * kRadPerDeg, 61, 43), Vec3d{0.15, -0.1, -1});
  const SamplingMap dense = uniform_map(61, 43, 4);
  for (const PixelFilter filter : {PixelFilter::box, PixelFilter::blackman_harris}) {
    Repeats a;
    Repeats b;
    TraceSettings settings;
    settings.filter = filter;
    for (int i = 0; i < kRepeats; ++i) {
      settings.seed = static_cast<std::uint64_t>(i + 1);
      a.means.push_back(integral(tracer.at_rest().trace(camera, 1, sparse, settings), sparse));
      b.means.push_back(integral(tracer.at_rest().trace(camera, 1, dense, settings), dense));
    }
    EXPECT_LT(std::fabs(welch_t(a, b)), kCriticalT) << a.mean() << " " << b.mean();
  }
}

}  // namespace
}  // namespace gazetrace::tracer_mean_test
