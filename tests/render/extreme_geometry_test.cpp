// SPDX-License-Identifier: Apache-2.0
// Triangles as they really occur in files: needles, points, lines, duplicates, and coordinates that are not numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gazetrace/error.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace::extreme_geometry_test {
namespace {

using namespace test;
using ::testing::HasSubstr;

void expect_clean(const SparseFrame& frame) {
  EXPECT_EQ(frame.stats.non_finite_samples, 0U);
  EXPECT_EQ(frame.stats.rejected_rays, 0U);
  for (std::size_t i = 0; i < frame.sum.size(); ++i) {
    ASSERT_TRUE(is_finite(frame.sum[i]) && std::isfinite(frame.sum_square_luminance[i]));
    ASSERT_GE(frame.sum[i].y, 0);
  }
}

// Triangles from every three vertices, without normals.
Geometry soup(const std::vector<std::array<Vec3f, 3>>& corners, std::int32_t material) {
  Geometry geometry;
  geometry.material = material;
  for (const auto& triangle : corners) {
    const auto first = static_cast<std::uint32_t>(geometry.positions.size());
    geometry.positions.insert(geometry.positions.end(), triangle.begin(), triangle.end());
    geometry.triangles.push_back({first, first + 1, first + 2});
  }
  return geometry;
}

// A square filled by a fan of needles a million times as long as wide: every pixel is still white under a white sky.
TEST(ExtremeGeometry, NeedlesFillASquare) {
  constexpr int kNeedles = 4096;
  for (const float length : {1.0F, 1e3F, 1e5F}) {
    std::vector<std::array<Vec3f, 3>> needles;
    for (int i = 0; i < kNeedles; ++i) {
      const float y0 = 2.0F * static_cast<float>(i) / kNeedles - 1;
      const float y1 = 2.0F * static_cast<float>(i + 1) / kNeedles - 1;
      needles.push_back({Vec3f{-length, y0, 0}, Vec3f{length, y0, 0}, Vec3f{length, y1, 0}});
      needles.push_back({Vec3f{-length, y0, 0}, Vec3f{length, y1, 0}, Vec3f{-length, y1, 0}});
    }
    Scene scene;
    scene.materials = {diffuse_material({1, 1, 1}), diffuse_material({0, 0, 0}, {1, 1, 1})};
    add_mesh(scene, {soup(needles, 0)});
    scene.environment = constant_environment({1, 1, 1});
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    PathTracer lit(scene, threads(2));
    const SparseFrame white =
        lit.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(32, 32, 16), settings);
    expect_clean(white);
    EXPECT_NEAR(mean_radiance(white).y, 1, 1e-3) << length;
    // The same needles as emitters on black: there are no gaps between them, and no light of 8192 emitters is lost.
    scene.environment = {};
    scene.meshes[0].geometries[0].material = 1;
    PathTracer lamps(scene, threads(2));
    const SparseFrame glow =
        lamps.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(32, 32, 16), settings);
    expect_clean(glow);
    EXPECT_NEAR(mean_radiance(glow).y, 1, 1e-4) << length;
  }
}

TEST(ExtremeGeometry, TrianglesWithoutAreaChangeNothing) {
  const Geometry floor = quad({{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}}, 0);
  std::vector<std::array<Vec3f, 3>> degenerate;
  for (int i = 0; i < 200; ++i) {
    const float x = static_cast<float>(i) / 100 - 1;
    const Vec3f p{x, 0.5F * x, 0.5F};
    const Vec3f q{x, -0.5F, 0.25F};
    degenerate.push_back({p, p, p});
    degenerate.push_back({p, q, q});
    degenerate.push_back({p, q, (p + q) * 0.5F});
    degenerate.push_back({p, p + Vec3f{1e-30F, 0, 0}, p + Vec3f{0, 1e-30F, 0}});
  }
  for (const Vec3f emission : {Vec3f{0, 0, 0}, Vec3f{3, 3, 3}}) {
    Scene scene;
    scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F}), diffuse_material({0, 0, 0}, emission)};
    scene.materials[1].double_sided = true;
    add_mesh(scene, {floor});
    scene.environment = constant_environment({1, 1, 1});
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    const Camera camera = camera_at({0, 0, 5}, {0, 0, 0}, 30);
    const SamplingMap map = uniform_map(32, 32, 16);
    const double without = mean_radiance(PathTracer(scene, threads(2)).at_rest().trace(camera, 1, map, settings)).y;
    add_mesh(scene, {soup(degenerate, 1)});
    const SparseFrame with = PathTracer(scene, threads(2)).at_rest().trace(camera, 1, map, settings);
    expect_clean(with);
    // Because of rounding, one ray in ten thousand may hit a line of no width; its effect must not be larger.
    EXPECT_NEAR(mean_radiance(with).y, without, 1e-3);
  }
}

TEST(ExtremeGeometry, DuplicatesAreOneSurface) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1}), diffuse_material({0, 0, 0}, {1, 1, 1})};
  const Geometry plate = quad({{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}}, 0);
  add_mesh(scene, {plate, plate, plate});
  scene.environment = constant_environment({1, 1, 1});
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  const Camera camera = camera_at({0, 0, 5}, {0, 0, 0}, 10);
  const SparseFrame lit = PathTracer(scene, threads(1)).at_rest().trace(camera, 1, uniform_map(16, 16, 16), settings);
  expect_clean(lit);
  EXPECT_NEAR(mean_radiance(lit).y, 1, 1e-3);
  // Three emitters in one place look like one and light a floor as one does, however light is found. One of them begins
  // its triangles with other corners, whose sums with an edge are rounded differently.
  scene.environment = {};
  const std::array<Vec3f, 4> lamp{
      {{-2.1F, -1.93F, 0.013F}, {2.07F, -2.03F, -0.017F}, {1.97F, 2.11F, 0.029F}, {-2.03F, 1.9F, 0.011F}}};
  const Geometry turned = quad({{lamp[2], lamp[3], lamp[0], lamp[1]}}, 1);
  scene.meshes[0].geometries = {quad(lamp, 1), quad(lamp, 1), turned};
  add_mesh(scene, {quad({{{-9, -9, 3}, {-9, 9, 3}, {9, 9, 3}, {9, -9, 3}}}, 0)});
  settings.max_bounces = 1;
  const Camera below = camera_at({0, 0, 1}, {0.1, 0, 3}, 60);
  std::array<double, 3> means{};
  for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only}) {
    settings.light_sampling = sampling;
    const SparseFrame frame =
        PathTracer(scene, threads(2)).at_rest().trace(below, 1, uniform_map(32, 32, 256), settings);
    expect_clean(frame);
    means[static_cast<std::size_t>(sampling)] = mean_radiance(frame).y;
  }
  EXPECT_NEAR(means[0] / means[2], 1, 0.01);
  EXPECT_NEAR(means[1] / means[2], 1, 0.01);
}

// A scene made by a program can still contain what loading refuses, and an instance may move finite numbers out of
// range.
TEST(ExtremeGeometry, VerticesThatAreNoNumbersAreRefusedByName) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const float bad : {kNan, kInfinite, -kInfinite, 3e38F}) {
    for (const bool shared : {false, true}) {
      Scene scene;
      scene.materials = {diffuse_material({1, 1, 1})};
      Geometry plate = quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0);
      plate.positions[2].y = bad;
      add_mesh(scene, {quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0), plate});
      scene.meshes[0].name = "plate";
      if (shared) {
        scene.instances.push_back({0, make_affine({5, 0, 0}, {}, {1, 1, 1})});
      }
      try {
        PathTracer tracer(scene, threads(1));
        FAIL() << bad;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), HasSubstr("plate"));
        EXPECT_THAT(error.what(), HasSubstr("primitive 1"));
        EXPECT_THAT(error.what(), HasSubstr("vertex 2"));
      }
    }
  }
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, {quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0)}, make_affine({}, {}, {1e30, 1, 1}));
  EXPECT_THROW(PathTracer(scene, threads(1)), Error);
}

}  // namespace
}  // namespace gazetrace::extreme_geometry_test
