// SPDX-License-Identifier: Apache-2.0
// Depth of field, compared with the closed forms of the thin lens.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/picture_evidence.hpp"
#include "trace/rays/camera_rays.hpp"

namespace gazetrace::lens_test {
namespace {

using namespace test;

constexpr int kSize = 128;
constexpr double kFocus = 4.0, kRadius = 0.05;

Material glowing() {
  return diffuse_material({0, 0, 0}, {1, 1, 1});
}

// An emissive disc with n corners about the view axis, `distance` in front of a camera at the origin.
Geometry disc(double distance, double radius) {
  constexpr int kCorners = 64;
  Geometry geometry;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * kPi * i / kCorners;
    geometry.positions.push_back(to_float({radius * std::cos(angle), radius * std::sin(angle), -distance}));
    geometry.normals.push_back({0, 0, 1});
    if (i > 1) {
      geometry.triangles.push_back({0, static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i)});
    }
  }
  return geometry;
}

Camera lens_camera(double radius_m, double yfov_deg = 10) {
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, yfov_deg);
  camera.lens = {radius_m, kFocus};
  return camera;
}

TraceSettings emission_only(std::uint64_t seed = 0) {
  TraceSettings settings;
  settings.max_bounces = 0;
  settings.seed = seed;
  return settings;
}

struct Spot {
  double flux = 0;           // mean radiance times the picture's area in tangents
  double second_moment = 0;  // of the squared distance from the axis, tangents
  double reach = 0;          // of the outermost lit pixel's centre
};

Spot measure_spot(const Scene& scene, const Camera& camera, std::uint64_t seed) {
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(kSize, kSize, 16);
  const SparseFrame frame = tracer.at_rest().trace(camera, 1, map, emission_only(seed));
  const double pixel = 2 * std::tan(camera.projection.yfov_rad / 2) / kSize;
  Spot spot;
  double sum = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const double value = static_cast<double>(frame.sum[i].y) / frame.count[i];
    const double x = (map.sites[i].block_x + 0.5 - kSize / 2.0) * pixel;
    const double y = (map.sites[i].block_y + 0.5 - kSize / 2.0) * pixel;
    sum += value;
    spot.second_moment += value * (x * x + y * y);
    spot.reach = value > 0 ? std::max(spot.reach, std::hypot(x, y)) : spot.reach;
  }
  spot.second_moment = spot.second_moment / sum - pixel * pixel / 6;  // a pixel's own spread
  spot.flux = sum * pixel * pixel;
  return spot;
}

// A small disc out of focus is the sum of two discs: its own picture, and the circle of confusion of diameter
// c = 2 R |d - f| / (d f) in tangents. A disc of radius r has the second moment r^2 / 2, and moments of a sum add up.
TEST(Lens, CircleOfConfusionHasTheDiameterOfTheThinLens) {
  const std::vector<double> distances{2.0, 2.5, 3.0, 6.0, 12.0};
  for (const double distance : distances) {
    const double own = 0.004;  // radius of the disc's own picture, tangents
    Scene scene;
    scene.materials = {glowing()};
    add_mesh(scene, {disc(distance, own * distance)});
    const double blur = kRadius * std::fabs(distance - kFocus) / (distance * kFocus);  // c / 2
    // A regular polygon of n corners: r^2 / 2 times (2 + cos(2 pi / n)) / 3, area r^2 (n / 2) sin(2 pi / n).
    const double corners = (2 + std::cos(2 * kPi / 64)) / 3;
    const double expected = 0.5 * (own * own * corners + blur * blur);
    const double area = own * own * 32 * std::sin(2 * kPi / 64);
    std::vector<double> moments, fluxes;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      const Spot spot = measure_spot(scene, lens_camera(kRadius), seed);
      moments.push_back(spot.second_moment);
      fluxes.push_back(spot.flux);
      const double pixel = 2 * std::tan(5 * kRadPerDeg) / kSize;
      EXPECT_LT(spot.reach, own + blur + pixel);
      EXPECT_GT(spot.reach, own + blur - 2 * pixel);
    }
    const MeanTest moment = t_test(moments, expected, 1e-4 * expected);
    const MeanTest flux = t_test(fluxes, area, 1e-4 * area);
    const double level = sidak(2 * distances.size());
    EXPECT_GT(moment.p_value, level) << distance << " m: " << moment.mean << " +- " << moment.standard_error
                                     << ", expected " << expected;
    EXPECT_GT(flux.p_value, level) << distance << " m: " << flux.mean << " +- " << flux.standard_error << ", expected "
                                   << area;
    EXPECT_LT(moment.standard_error, 0.01 * expected) << "too noisy to mean anything";
  }
}

TEST(Lens, WhatIsInFocusIsAsSharpAsThroughAPinhole) {
  Scene scene;
  scene.materials = {glowing()};
  // Half the plane in focus emits light; its edge runs through the middle of a pixel's column.
  const double edge = 10.5 * 2 * std::tan(5 * kRadPerDeg) / kSize * kFocus;
  const auto e = static_cast<float>(edge);
  const auto z = static_cast<float>(-kFocus);
  add_mesh(scene, {quad({{{e, -9, z}, {9, -9, z}, {9, 9, z}, {e, 9, z}}}, 0)});
  PathTracer tracer(scene, threads(1));
  const SamplingMap map = uniform_map(kSize, kSize, 16);
  const SparseFrame sharp = tracer.at_rest().trace(lens_camera(0), 1, map, emission_only());
  const SparseFrame lens = tracer.at_rest().trace(lens_camera(kRadius), 1, map, emission_only());
  double differing = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    // Rounding may move a sample that lies on the edge, nothing else.
    const double difference = std::fabs(sharp.sum[i].y - lens.sum[i].y);
    differing += difference;
    EXPECT_TRUE(difference == 0 || map.sites[i].block_x == kSize / 2 + 10) << map.sites[i].block_x;
  }
  EXPECT_LE(differing, 4);
  EXPECT_GT(mean_radiance(sharp).y, 0.3);
}

TEST(Lens, AnOrthographicCameraBlursAlike) {
  Scene scene;
  scene.materials = {glowing()};
  const double distance = 6, own = 0.05;
  add_mesh(scene, {disc(distance, own)});
  Camera camera = lens_camera(kRadius);
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 0.25;
  // A bundle through a disc of radius R that meets at f has the radius R |d - f| / f at d.
  const double blur = kRadius * (distance - kFocus) / kFocus;
  const double expected = 0.5 * (own * own * (2 + std::cos(2 * kPi / 64)) / 3 + blur * blur);
  const double pixel = 2 * camera.projection.ymag_m / kSize;
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(kSize, kSize, 64);
  const SparseFrame frame = tracer.at_rest().trace(camera, 1, map, emission_only());
  double sum = 0, moment = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const double x = (map.sites[i].block_x + 0.5 - kSize / 2.0) * pixel;
    const double y = (map.sites[i].block_y + 0.5 - kSize / 2.0) * pixel;
    sum += static_cast<double>(frame.sum[i].y);
    moment += static_cast<double>(frame.sum[i].y) * (x * x + y * y);
  }
  EXPECT_NEAR(moment / sum - pixel * pixel / 6, expected, 0.01 * expected);
}

TEST(Lens, ClippingPlanesStayPlanes) {
  Scene scene;
  scene.materials = {glowing()};
  add_mesh(scene, {quad({{{-9, -9, -5}, {9, -9, -5}, {9, 9, -5}, {-9, 9, -5}}}, 0)});
  PathTracer tracer(scene, threads(1));
  Camera camera = lens_camera(1.0, 60);
  camera.projection.near_m = 4.999;
  camera.projection.far_m = 5.001;
  EXPECT_EQ(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(16, 16, 16), emission_only())).y, 1.0);
  camera.projection.near_m = 5.001;
  camera.projection.far_m = 0;
  EXPECT_EQ(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(16, 16, 16), emission_only())).y, 0.0);
}

TEST(Lens, TheDiscIsFilledEvenly) {
  // 16 equal cells of the disc: four quarters times four rings of equal area.
  constexpr int kSide = 1024;  // a row of cells to either side of a ring is 0.6 %
  std::vector<int> cells(16, 0);
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2f p = concentric_disk(
        {(static_cast<float>(i % kSide) + 0.5F) / kSide, (static_cast<float>(i / kSide) + 0.5F) / kSide});
    const double r2 = p.x * p.x + p.y * p.y;
    ASSERT_LE(r2, 1 + 1e-6);
    const int ring = std::min(static_cast<int>(4 * r2), 3);
    ++cells[static_cast<std::size_t>(4 * ring + (p.x < 0 ? 1 : 0) + (p.y < 0 ? 2 : 0))];
  }
  for (const int count : cells) {
    EXPECT_NEAR(count, kSide * kSide / 16.0, 0.01 * kSide * kSide / 16.0);
  }
}

TEST(Lens, FNumberAndSensorGiveTheRadius) {
  // 24 mm high, 50 mm focal length: a field of 2 atan(12 / 50). At f/2 the opening is 25 mm wide.
  EXPECT_NEAR(lens_radius_m(2, 24, 2 * std::atan2(12, 50)), 0.0125, 1e-12);
  EXPECT_EQ(lens_radius_m(0, 24, 1), 0);
}

TEST(Lens, AFurnaceStaysAFurnace) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, box(0.7F, false, 0), make_affine({0, 0, -3}, normalize(Quatd{0.1, 0.3, 0, 1}), {1, 1, 1}));
  scene.environment = constant_environment({1, 1, 1});
  PathTracer tracer(scene, threads(2));
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  const SparseFrame frame = tracer.at_rest().trace(lens_camera(0.2, 40), 1, uniform_map(48, 48, 64), settings);
  EXPECT_NEAR(mean_radiance(frame).y, 1, 1e-3);
}

TEST(Lens, TheSameBitsForAnyThreadCount) {
  Scene scene;
  scene.materials = {diffuse_material({0.5F, 0.6F, 0.7F})};
  add_mesh(scene, box(0.7F, false, 0), make_affine({0, 0, -3}, normalize(Quatd{0.1, 0.3, 0, 1}), {1, 1, 1}));
  scene.environment = constant_environment({1, 1, 1});
  Camera camera = lens_camera(0.2, 40);
  camera.shutter_poses = {camera.pose, look_at({0.1, 0, 0}, {0.2, 0, -1}, {0, 1, 0})};
  const SamplingMap map = uniform_map(100, 70, 4);
  const SparseFrame one = PathTracer(scene, threads(1)).at_rest().trace(camera, 1, map, {});
  const SparseFrame two = PathTracer(scene, threads(2)).at_rest().trace(camera, 1, map, {});
  EXPECT_TRUE(same_samples(one, two, map));
}

}  // namespace
}  // namespace gazetrace::lens_test
