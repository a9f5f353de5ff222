// SPDX-License-Identifier: Apache-2.0
// Bodies that move from frame to frame and while the shutter is open, compared with closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/gltf_builder.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace::object_blur_test {
namespace {

using namespace test;

constexpr int kWidth = 64, kHeight = 8, kSeeds = 16;
constexpr std::int64_t kSecond = 1'000'000'000;

// Shows x from -4 to 4 and y from -0.5 to 0.5 at any depth.
Camera flat_camera() {
  Camera camera = camera_at({0, 0, 5}, {0, 0, 0});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 0.5;
  return camera;
}

template <class At>
std::int32_t add_motion(Scene& scene, const At& at) {
  scene.motions.push_back({at});
  return static_cast<std::int32_t>(scene.motions.size() - 1);
}

Affine moved(const Vec3d& by) {
  return make_affine(by, {}, {1, 1, 1});
}

// An emissive box of half width 1 that slides to the right at 2 m/s, with x = 0 at t = 1 s.
Scene sliding_box() {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  add_mesh(scene, box(1, false, 0));
  scene.instances[0].motion = add_motion(scene, [](std::int64_t t) {
    return moved({2e-9 * static_cast<double>(t - kSecond), 0, 0});
  });
  return scene;
}

std::vector<std::vector<double>> columns(const PosedScene& posed, const TraceSettings& base, std::uint32_t spp = 64) {
  const SamplingMap map = uniform_map(kWidth, kHeight, spp);
  std::vector<std::vector<double>> result(kWidth);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TraceSettings settings = base;
    settings.seed = seed;
    const SparseFrame frame = posed.trace(flat_camera(), 1, map, settings);
    EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
    std::vector<double> sums(kWidth, 0);
    for (std::size_t i = 0; i < map.sites.size(); ++i) {
      sums[static_cast<std::size_t>(map.sites[i].block_x)] += static_cast<double>(frame.sum[i].y) / frame.count[i];
    }
    for (std::size_t x = 0; x < sums.size(); ++x) {
      result[x].push_back(sums[x] / kHeight);
    }
  }
  return result;
}

TraceSettings emission_only() {
  TraceSettings settings;
  settings.max_bounces = 0;
  return settings;
}

// `lit(x)`: the share of the time for which x is covered; averaged over a column's width.
template <class Lit>
void expect_columns(const std::vector<std::vector<double>>& measured, const Lit& lit, int least_ramp) {
  constexpr int kSteps = 4096;
  int between = 0;
  for (int c = 0; c < kWidth; ++c) {
    double expected = 0;
    for (int k = 0; k < kSteps; ++k) {
      expected += lit((c + (k + 0.5) / kSteps - kWidth / 2.0) / 8.0) / kSteps;
    }
    between += expected > 0.01 && expected < 0.99 ? 1 : 0;
    const MeanTest result = t_test(measured[static_cast<std::size_t>(c)], expected, 1e-4);
    EXPECT_GT(result.p_value, sidak(kWidth))
        << "column " << c << ": " << result.mean << " +- " << result.standard_error << ", expected " << expected;
    EXPECT_LT(result.standard_error, 0.01) << "too noisy to mean anything";
  }
  EXPECT_GE(between, least_ramp) << "no ramp to test";
}

double share(double low, double high) {
  return std::clamp(std::min(high, 1.0) - std::max(low, 0.0), 0.0, 1.0);
}

TEST(ObjectBlur, ASlidingBoxBecomesARamp) {
  const Scene scene = sliding_box();
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({kSecond, kSecond + kSecond / 2});  // from x = 0 to x = 1
  // x is covered while |x - t| < 1, t in [0, 1].
  expect_columns(
      columns(posed, emission_only()), [](double x) { return share(x - 1, x + 1); }, 14);
}

TEST(ObjectBlur, AnInstantIsSharpAndWhereItShouldBe) {
  const Scene scene = sliding_box();
  PathTracer tracer(scene, threads(2));
  for (const double at_s : {0.0, 1.0, 1.75}) {
    const auto t = static_cast<std::int64_t>(at_s * 1e9);
    const PosedScene posed = tracer.at({t, t});
    const double center = 2 * (at_s - 1);
    const auto measured = columns(posed, emission_only(), 4);
    for (int c = 0; c < kWidth; ++c) {
      const double x = (c + 0.5 - kWidth / 2.0) / 8.0;
      EXPECT_EQ(measured[static_cast<std::size_t>(c)][0], std::fabs(x - center) < 1 ? 1.0 : 0.0) << at_s << ' ' << x;
    }
  }
}

TEST(ObjectBlur, AWheelTurnsOnACircle) {
  // A small glowing square on a spoke of 3 m turns by 60 degrees: where it is seen says how even and how round.
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  add_mesh(scene, {quad({{{-0.05F, 2.95F, 0}, {0.05F, 2.95F, 0}, {0.05F, 3.05F, 0}, {-0.05F, 3.05F, 0}}}, 0)});
  const double turn = 60 * kRadPerDeg;
  scene.instances[0].motion = add_motion(scene, [turn](std::int64_t t) {
    const double angle = turn * (0.5 - static_cast<double>(t) / kSecond);
    return make_affine({}, {0, 0, std::sin(angle / 2), std::cos(angle / 2)}, {1, 1, 1});
  });
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({0, kSecond});
  Camera camera = flat_camera();
  camera.projection.ymag_m = 4;
  const SamplingMap map = uniform_map(128, 128, 256);
  const SparseFrame frame = posed.trace(camera, 1, map, emission_only());
  double sum = 0, radius = 0, least = 9, most = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const double value = static_cast<double>(frame.sum[i].y);
    const double x = (map.sites[i].block_x + 0.5) / 16 - 4;
    const double y = 4 - (map.sites[i].block_y + 0.5) / 16;
    sum += value;
    radius += value * std::hypot(x, y);
    if (value > 0) {
      least = std::min(least, std::atan2(x, y));
      most = std::max(most, std::atan2(x, y));
    }
  }
  EXPECT_NEAR(radius / sum, 3.0, 0.01);
  EXPECT_NEAR(sum / 256 / (16 * 16), 0.01, 0.0005);  // its area
  EXPECT_NEAR(most, turn / 2 + 0.05 / 3, 0.02);
  EXPECT_NEAR(least, -turn / 2 - 0.05 / 3, 0.02);
}

// Shading follows the motion: a lit plate that turns shows the mean of the cosine.
TEST(ObjectBlur, NormalsTurnWithTheirBody) {
  for (const double mirror : {1.0, -1.0}) {
    Scene scene;
    scene.materials = {diffuse_material({1, 1, 1})};
    scene.materials[0].double_sided = true;
    add_mesh(scene, {quad({{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}}, 0)});
    const double turn = 1.0;  // rad
    scene.instances[0].motion = add_motion(scene, [=](std::int64_t t) {
      const double angle = turn * static_cast<double>(t) / kSecond;
      return make_affine({}, {0, std::sin(angle / 2), 0, std::cos(angle / 2)}, {mirror, 1, 1});
    });
    PunctualLight sun;
    sun.kind = LightKind::directional;
    sun.direction = {0, 0, -1};
    sun.intensity = {1, 1, 1};
    scene.lights = {sun};
    PathTracer tracer(scene, threads(2));
    const PosedScene posed = tracer.at({0, kSecond});
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    settings.max_bounces = 1;
    settings.light_sampling = LightSampling::mis;
    std::vector<double> means;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      settings.seed = seed;
      means.push_back(mean_radiance(posed.trace(flat_camera(), 1, uniform_map(8, 8, 32), settings)).y);
    }
    const double expected = std::sin(turn) / turn / kPi;
    const MeanTest result = t_test(means, expected, 2e-4 * expected);
    EXPECT_GT(result.p_value, sidak(2)) << result.mean << " +- " << result.standard_error << ", expected " << expected;
    EXPECT_LT(result.standard_error, 0.01 * expected);
  }
}

// A mirroring matrix reverses the winding, not the front: an emitter that faces forwards does so also while it slides.
TEST(ObjectBlur, MirroredBodiesKeepTheirFront) {
  for (const double mirror : {1.0, -1.0}) {
    Scene scene;
    scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
    add_mesh(scene, {quad({{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}}, 0)});
    scene.instances[0].motion = add_motion(scene, [=](std::int64_t t) {
      return make_affine({1e-9 * static_cast<double>(t), 0, 0}, {}, {mirror, 1, 1});
    });
    PathTracer tracer(scene, threads(1));
    const PosedScene posed = tracer.at({0, kSecond});
    const SamplingMap map = uniform_map(8, 8, 4);
    EXPECT_EQ(mean_radiance(posed.trace(camera_at({0, 0, 5}, {}), 1, map, emission_only())).y, 1) << mirror;
    EXPECT_EQ(mean_radiance(posed.trace(camera_at({0, 0, -5}, {}), 1, map, emission_only())).y, 0) << mirror;
  }
}

TEST(ObjectBlur, ShadowsMoveToo) {
  // A plate slides in front of the sun: half of the time the floor is in its shadow.
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, {quad({{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}}, 0)});
  add_mesh(scene, {quad({{{-20, -20, 9}, {20, -20, 9}, {20, 20, 9}, {-20, 20, 9}}}, 0)});  // behind the camera
  scene.instances[1].motion = add_motion(scene, [](std::int64_t t) {
    return moved({100.0 * static_cast<double>(t) / kSecond - 50, 0, 0});
  });
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {0, 0, -1};
  sun.intensity = {1, 1, 1};
  scene.lights = {sun};
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({0, kSecond});
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  settings.max_bounces = 1;
  // In the shadow while |100 t - 50 - x| < 20: 0.4 of the time, everywhere in the picture.
  expect_columns(
      columns(posed, settings), [](double) { return 0.6 / kPi; }, 64);
}

TEST(ObjectBlur, AFurnaceStaysAFurnace) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, box(0.4F, false, 0));
  add_mesh(scene, box(0.2F, false, 0), make_affine({0.9, 0.3, 0}, {}, {1, 1, 1}));
  scene.instances[0].motion = add_motion(scene, [](std::int64_t t) {
    const double s = static_cast<double>(t) / kSecond;
    return make_affine({s - 1.5, 0, 0}, normalize(Quatd{0.3 * s, 0.2, 0.1, 1}), {1 + s, 1, 0.5});
  });
  scene.environment = constant_environment({1, 1, 1});
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({0, kSecond});
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  const SparseFrame frame = posed.trace(camera_at({2, 2, 4}, {0, 0, 0}), 1, uniform_map(64, 48, 64), settings);
  EXPECT_NEAR(mean_radiance(frame).y, 1, 1e-3);
}

TEST(ObjectBlur, MovingEmittersShineByRays) {
  // The sliding box glows on a floor: MIS and BSDF samples alone agree; the still lamp beside it is sampled as ever.
  Scene scene = sliding_box();
  scene.materials.push_back(diffuse_material({0.8F, 0.8F, 0.8F}));
  add_mesh(scene, {quad({{{-9, -2, 9}, {9, -2, 9}, {9, -2, -9}, {-9, -2, -9}}}, 1)});
  add_mesh(scene, {quad({{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}}, 0)});
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({0, 2 * kSecond});
  std::array<std::vector<double>, 2> means;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    for (const bool mis : {false, true}) {
      TraceSettings settings;
      settings.seed = seed;
      settings.light_sampling = mis ? LightSampling::mis : LightSampling::bsdf_only;
      means[mis ? 1 : 0].push_back(
          mean_radiance(posed.trace(camera_at({0, 4, 8}, {0, -2, 0}), 1, uniform_map(24, 16, 64), settings)).y);
    }
  }
  std::vector<double> differences;
  for (std::size_t i = 0; i < means[0].size(); ++i) {
    differences.push_back(means[0][i] - means[1][i]);
  }
  const MeanTest result = t_test(differences, 0, 0);
  EXPECT_GT(result.p_value, 1e-3) << result.mean << " +- " << result.standard_error;
  EXPECT_LT(result.standard_error, 0.02 * means[0][0]);
}

TEST(ObjectBlur, TheSameBitsForAnyThreadCountAndOrder) {
  Scene scene = sliding_box();
  scene.materials.push_back(diffuse_material({0.8F, 0.5F, 0.2F}));
  add_mesh(scene, box(0.3F, false, 1));
  scene.environment = constant_environment({1, 1, 1});
  const SamplingMap map = uniform_map(90, 60, 4);
  PathTracer one(scene, threads(1));
  const SparseFrame a = one.at({0, kSecond}).trace(flat_camera(), 1, map, {});
  PathTracer two(scene, threads(2));
  const SparseFrame resting = two.at_rest().trace(flat_camera(), 1, map, {});
  const PosedScene other = two.at({kSecond, 3 * kSecond});
  const PosedScene instant = two.at({5, 5});
  const PosedScene same = two.at({0, kSecond});
  EXPECT_TRUE(same_samples(same.trace(flat_camera(), 1, map, {}), a, map));
  EXPECT_NE(a.sum, instant.trace(flat_camera(), 1, map, {}).sum);
  EXPECT_NE(a.sum, other.trace(flat_camera(), 1, map, {}).sum);
  // A pose stays what it is, whatever others the tracer has been in since.
  EXPECT_TRUE(same_samples(same.trace(flat_camera(), 1, map, {}), a, map));
  EXPECT_NE(a.sum, resting.sum);
  EXPECT_TRUE(same_samples(two.at_rest().trace(flat_camera(), 1, map, {}), resting, map));
}

TEST(ObjectBlur, WhatShrinksToNothingIsNotThere) {
  Scene scene = sliding_box();
  scene.motions[0].to_world_at = [](std::int64_t t) {
    const double s = t < kSecond ? 1.0 : 0.0;
    return make_affine({}, {}, {s, s, s});
  };
  PathTracer tracer(scene, threads(1));
  const auto mean = [&](std::int64_t t) {
    const PosedScene posed = tracer.at({t, t});
    return mean_radiance(posed.trace(flat_camera(), 1, uniform_map(kWidth, kHeight, 4), emission_only())).y;
  };
  EXPECT_NEAR(mean(0), 0.25, 1e-6);
  EXPECT_EQ(mean(2 * kSecond), 0);
  EXPECT_NEAR(mean(0), 0.25, 1e-6);
}

TEST(ObjectBlur, GltfAnimationsMoveMeshes) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.json["nodes"][0]["translation"] = {7, 0, 0};
  const int parent = builder.add_node({{"children", {0}}, {"scale", {2, 2, 2}}}, false);
  builder.json["scenes"][0]["nodes"] = {parent};
  builder.add_triangle();  // stands still
  const int input = builder.add<float>({0, 1}, 1);
  const int output = builder.add<float>({0, 0, 0, 10, 0, 0}, 3);
  builder.json["animations"] = {
      {{"samplers", {{{"input", input}, {"output", output}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", parent}, {"path", "translation"}}}}}}}};
  const TempFolder folder;
  const Scene scene = load_scene(folder.write("moving.gltf", builder.text()));
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.instances.size(), 2U);
  ASSERT_EQ(scene.motions.size(), 1U);
  EXPECT_TRUE(features_of(scene).motion);
  const auto moving = std::find_if(scene.instances.begin(), scene.instances.end(),
                                   [](const Instance& instance) { return instance.motion >= 0; });
  ASSERT_NE(moving, scene.instances.end());
  EXPECT_EQ(moving->to_world.t, (Vec3d{14, 0, 0}));
  const Motion& motion = scene.motions[static_cast<std::size_t>(moving->motion)];
  EXPECT_EQ(motion.to_world_at(0).t, (Vec3d{14, 0, 0}));
  EXPECT_EQ(motion.to_world_at(kSecond / 2).t, (Vec3d{19, 0, 0}));
  EXPECT_EQ(motion.to_world_at(9 * kSecond).t, (Vec3d{24, 0, 0}));
  EXPECT_EQ(motion.to_world_at(0).x, (Vec3d{2, 0, 0}));
}

}  // namespace
}  // namespace gazetrace::object_blur_test
