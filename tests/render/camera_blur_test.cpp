// SPDX-License-Identifier: Apache-2.0
// A camera that moves while the shutter is open: the coverage of an edge is compared with its closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/picture_evidence.hpp"
#include "trace/rays/camera_rays.hpp"

namespace gazetrace::camera_blur_test {
namespace {

using namespace test;

constexpr int kWidth = 64, kHeight = 16, kSeeds = 16;
constexpr double kYfovDeg = 10, kDistance = 5;

double pixel_tangent() {
  return 2 * std::tan(kYfovDeg / 2 * kRadPerDeg) / kHeight;
}

// Everything to the right of x = `edge_m`, at the distance, emits light.
Scene edge_scene(double edge_m) {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  const auto e = static_cast<float>(edge_m);
  const auto z = static_cast<float>(-kDistance);
  add_mesh(scene, {quad({{{e, -50, z}, {50, -50, z}, {50, 50, z}, {e, 50, z}}}, 0)});
  return scene;
}

// The mean radiance of every column, with one value per seed.
std::vector<std::vector<double>> columns(const Scene& scene, const Camera& camera) {
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(kWidth, kHeight, 64);
  std::vector<std::vector<double>> result(kWidth);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TraceSettings settings;
    settings.max_bounces = 0;
    settings.seed = seed;
    const SparseFrame frame = tracer.at_rest().trace(camera, 1, map, settings);
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

// `lit(tangent)` is the share of the time for which that tangent sees the emitter; it is averaged over a column's
// width.
template <class Lit>
void expect_columns(const std::vector<std::vector<double>>& measured, const Lit& lit) {
  constexpr int kSteps = 4096;
  int between = 0;
  for (int x = 0; x < kWidth; ++x) {
    double expected = 0;
    for (int k = 0; k < kSteps; ++k) {
      expected += lit((x + (k + 0.5) / kSteps - kWidth / 2.0) * pixel_tangent()) / kSteps;
    }
    const std::vector<double>& means = measured[static_cast<std::size_t>(x)];
    between += expected > 0.01 && expected < 0.99 ? 1 : 0;
    const MeanTest result = t_test(means, expected, 1e-4);
    EXPECT_GT(result.p_value, sidak(kWidth))
        << "column " << x << ": " << result.mean << " +- " << result.standard_error << ", expected " << expected;
    EXPECT_LT(result.standard_error, 0.01) << "too noisy to mean anything";
  }
  EXPECT_GT(between, 8) << "no ramp to test";
}

double share_after(double t) {
  return 1 - std::clamp(t, 0.0, 1.0);
}

TEST(CameraBlur, AnEdgeBecomesARampWhenTheCameraSlides) {
  const double from = -0.35, to = 0.45;  // m
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, kYfovDeg);
  for (const double x : {from, to}) {
    camera.shutter_poses.push_back(look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}));
  }
  const double edge = 0.1;
  // Tangent u at time t meets the plane at from + (to - from) t + u d.
  expect_columns(columns(edge_scene(edge), camera),
                 [&](double u) { return share_after((edge - u * kDistance - from) / (to - from)); });
}

TEST(CameraBlur, APanTurnsAtAnEvenRate) {
  const double turn = 8 * kRadPerDeg;  // to the right
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, kYfovDeg);
  for (const double angle : {-turn / 2, turn / 2}) {
    camera.shutter_poses.push_back(look_at({0, 0, 0}, {std::sin(angle), 0, -std::cos(angle)}, {0, 1, 0}));
  }
  const double edge = kDistance * std::tan(1 * kRadPerDeg);
  expect_columns(columns(edge_scene(edge), camera),
                 [&](double u) { return share_after((1 * kRadPerDeg - std::atan(u) + turn / 2) / turn); });
}

TEST(CameraBlur, PosesBetweenAreAtEqualSteps) {
  // There and back again in the second half: the same ramp, passed twice as fast.
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, kYfovDeg);
  for (const double x : {-0.4, 0.4, -0.4}) {
    camera.shutter_poses.push_back(look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}));
  }
  expect_columns(columns(edge_scene(0), camera), [&](double u) { return share_after((0.4 - u * kDistance) / 0.8); });
}

TEST(CameraBlur, EqualPosesAreASharpPicture) {
  const Scene scene = edge_scene(0.1);
  PathTracer tracer(scene, threads(1));
  const Camera still = camera_at({0, 0, 0}, {0, 0, -1}, kYfovDeg);
  Camera open = still;
  open.shutter_poses = {still.pose, still.pose, still.pose};
  const SamplingMap map = uniform_map(kWidth, kHeight, 8);
  TraceSettings settings;
  settings.guides = true;
  const SparseFrame a = tracer.at_rest().trace(still, 1, map, settings);
  const SparseFrame b = tracer.at_rest().trace(open, 1, map, settings);
  EXPECT_TRUE(same_samples(a, b, map));
  for (std::size_t i = 0; i < a.guides.size(); ++i) {
    EXPECT_EQ(a.guides[i].depth_m, b.guides[i].depth_m);
  }
}

TEST(CameraBlur, DepthIsAlongTheViewOfTheMoment) {
  const Scene scene = edge_scene(-50);
  PathTracer tracer(scene, threads(1));
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, kYfovDeg);
  for (const double z : {0.0, -2.0}) {
    camera.shutter_poses.push_back(look_at({0, 0, z}, {0, 0, -5}, {0, 1, 0}));
  }
  TraceSettings settings;
  settings.guides = true;
  const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 256), settings);
  for (const GuideSums& guide : frame.guides) {
    EXPECT_NEAR(guide.depth_m / 256, kDistance - 1, 0.02);
  }
}

}  // namespace
}  // namespace gazetrace::camera_blur_test
