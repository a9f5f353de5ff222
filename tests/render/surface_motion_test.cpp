// SPDX-License-Identifier: Apache-2.0
// Where surfaces were: cameras, bodies and shapes whose ways have closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "render/tracer_scenes.hpp"

namespace gazetrace::surface_motion_test {
namespace {

using namespace test;

constexpr int kWidth = 48, kHeight = 32;
constexpr std::int64_t kSecond = 1'000'000'000;

Scene wall_scene() {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, {quad({{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}}, 0)});
  return scene;
}

Camera camera_in(const Vec3d& position, double yaw_rad = 0) {
  Camera camera;
  camera.pose = {position, {0, std::sin(yaw_rad / 2), 0, std::cos(yaw_rad / 2)}};
  camera.projection.yfov_rad = 50 * kRadPerDeg;
  return camera;
}

double focal_px() {
  return kHeight / 2.0 / std::tan(25 * kRadPerDeg);
}

TEST(SurfaceMotion, AMovingCameraShiftsAWall) {
  const Scene scene = wall_scene();
  PathTracer tracer(scene, threads(2));
  const SurfaceMotion motion =
      tracer.at_rest().surface_motion(camera_in({0.3, 0.1, 5}), kWidth, kHeight, {camera_in({0, 0, 5}), 0});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_NEAR(motion.other_px(x, y).x, x + 0.5 + focal_px() * 0.3 / 5, 1e-4);
      EXPECT_NEAR(motion.other_px(x, y).y, y + 0.5 - focal_px() * 0.1 / 5, 1e-4);
      EXPECT_NEAR(motion.depth_m(x, y), 5, 1e-5);
      EXPECT_NEAR(motion.other_depth_m(x, y), 5, 1e-5);
      EXPECT_EQ(motion.object(x, y), 1U);
    }
  }
}

TEST(SurfaceMotion, ATurningCameraMovesWallAndSkyAlike) {
  Scene scene = wall_scene();
  scene.meshes[0].geometries[0].positions = {{-9, -9, 0}, {0, -9, 0}, {0, 9, 0}, {-9, 9, 0}};  // the left half
  PathTracer tracer(scene, threads(2));
  const double turned = 5 * kRadPerDeg;
  const SurfaceMotion motion =
      tracer.at_rest().surface_motion(camera_in({0, 0, 5}), kWidth, kHeight, {camera_in({0, 0, 5}, turned), 0});
  for (const int x : {3, 20, 30, 45}) {
    // On the horizon's row the angle to the axis grows by the turn; the earlier camera looked to the left.
    const double angle = std::atan((x + 0.5 - kWidth / 2.0) / focal_px()) + turned;
    const double between = 0.5 * (motion.other_px(x, kHeight / 2).x + motion.other_px(x, kHeight / 2 - 1).x);
    EXPECT_NEAR(between, kWidth / 2.0 + focal_px() * std::tan(angle), 2e-3);
    EXPECT_EQ(motion.object(x, 9), x < kWidth / 2 ? 1U : 0U);
    EXPECT_EQ(std::isinf(motion.depth_m(x, 9)), x >= kWidth / 2);
  }
}

// A camera without perspective sees one place of the sky, at every pixel, as long as it does not turn.
TEST(SurfaceMotion, TheSkyOfAShiftedOrthographicCameraStays) {
  Scene scene = wall_scene();
  scene.meshes[0].geometries[0].positions = {{-9, -9, 0}, {0, -9, 0}, {0, 9, 0}, {-9, 9, 0}};  // the left half
  PathTracer tracer(scene, threads(2));
  const auto camera = [](const Vec3d& position, double yaw_rad = 0) {
    Camera plain = camera_in(position, yaw_rad);
    plain.projection.kind = ProjectionKind::orthographic;
    plain.projection.ymag_m = 2;
    return plain;
  };
  const SurfaceMotion shifted =
      tracer.at_rest().surface_motion(camera({0.3, 0.1, 5}), kWidth, kHeight, {camera({0, 0, 5}), 0});
  const SurfaceMotion turned =
      tracer.at_rest().surface_motion(camera({0, 0, 5}), kWidth, kHeight, {camera({0, 0, 5}, 0.1), 0});
  int misses = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth - 10; x < kWidth; ++x) {
      misses += shifted.object(x, y) == 0 ? 1 : 0;
      EXPECT_EQ(shifted.other_px(x, y), (Vec2d{x + 0.5, y + 0.5}));
      EXPECT_TRUE(std::isnan(turned.other_px(x, y).x));
    }
  }
  EXPECT_EQ(misses, 10 * kHeight);
}

TEST(SurfaceMotion, WhatStandsStillStaysToTheBit) {
  const Scene scene = wall_scene();
  PathTracer tracer(scene, threads(2));
  const Camera camera = camera_in({0.123, 4.56, 7.89}, 0.3);
  const SurfaceMotion motion = tracer.at_rest().surface_motion(camera, kWidth, kHeight, {camera, 0});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_EQ(motion.other_px(x, y), (Vec2d{x + 0.5, y + 0.5}));
    }
  }
}

TEST(SurfaceMotion, BehindTheEarlierCameraIsNowhere) {
  const Scene scene = wall_scene();
  PathTracer tracer(scene, threads(2));
  const SurfaceMotion motion =
      tracer.at_rest().surface_motion(camera_in({0, 0, 5}), kWidth, kHeight, {camera_in({0, 0, -5}), 0});
  EXPECT_TRUE(std::isnan(motion.other_px(20, 20).x));
}

// A small square before the wall moves by (0.4, 0, 1) and turns by 90 degrees about its own normal.
TEST(SurfaceMotion, ABodyCarriesItsSurface) {
  Scene scene = wall_scene();
  add_mesh(scene, {quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0)});
  scene.motions.push_back({[](std::int64_t t) {
    const double s = static_cast<double>(t) / kSecond;
    const double angle = s * kPi / 2;
    return make_affine({0.4 * s, 0, 1 + s}, {0, 0, std::sin(angle / 2), std::cos(angle / 2)}, {1, 1, 1});
  }});
  scene.instances[1].motion = 0;
  PathTracer tracer(scene, threads(2));
  const Camera camera = camera_in({0, 0, 5});
  const SurfaceMotion motion = tracer.at({kSecond, kSecond}).surface_motion(camera, kWidth, kHeight, {camera, 0});
  int on_body = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (motion.object(x, y) != 2) {
        EXPECT_EQ(motion.other_px(x, y), (Vec2d{x + 0.5, y + 0.5}));
        continue;
      }
      ++on_body;
      const double px = (x + 0.5 - kWidth / 2.0) * 3 / focal_px() - 0.4;  // on the body, in its present axes
      const double py = -(y + 0.5 - kHeight / 2.0) * 3 / focal_px();
      EXPECT_NEAR(motion.other_px(x, y).x, kWidth / 2.0 + focal_px() / 4 * py, 1e-3);
      EXPECT_NEAR(motion.other_px(x, y).y, kHeight / 2.0 + focal_px() / 4 * px, 1e-3);
      EXPECT_NEAR(motion.other_depth_m(x, y), 4, 1e-5);
    }
  }
  EXPECT_GT(on_body, 100);
}

// A square whose right edge moves out from x = 1 to x = 2, and one that a joint turns about y.
TEST(SurfaceMotion, AShapeCarriesItsSurface) {
  Scene scene = wall_scene();
  scene.meshes.clear();
  scene.instances.clear();
  Geometry square = quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0);
  MorphTarget wider;
  wider.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  square.morph_targets.push_back(wider);
  square.influences = {1, {0, 0, 0, 0}, {1, 1, 1, 1}};
  add_mesh(scene, {square});
  Deformation deformation;
  deformation.pose_at = [](std::int64_t t) {
    const double s = static_cast<double>(t) / kSecond;
    return MeshPose{{s}, {make_affine({0, 0, s}, {0, std::sin(0.25 * s), 0, std::cos(0.25 * s)}, {1, 1, 1})}};
  };
  deformation.rest = deformation.pose_at(0);
  scene.deformations.push_back(deformation);
  scene.instances[0].deformation = 0;
  PathTracer tracer(scene, threads(2));
  const Camera camera = camera_in({0, 0, 5});
  const PixelProjection view(camera, kWidth, kHeight);
  // Forwards and backwards in time: the same points.
  for (const bool forwards : {true, false}) {
    const double now_s = forwards ? 1 : 0;
    const double then_s = 1 - now_s;
    const std::int64_t now_ns = static_cast<std::int64_t>(now_s) * kSecond;
    const SurfaceMotion motion =
        tracer.at({now_ns, now_ns})
            .surface_motion(camera, kWidth, kHeight, {camera, static_cast<std::int64_t>(then_s) * kSecond});
    const auto place = [](double s, double u, double y) {  // u: 0..1 across
      const double x = -1 + u * (2 + s);
      return Vec3d{x * std::cos(0.5 * s), y, -x * std::sin(0.5 * s) + s};
    };
    int seen = 0;
    for (double u = 0.05; u < 1; u += 0.1) {
      for (double y = -0.9; y < 1; y += 0.3) {
        // The point's pixel now; its center lies elsewhere on the surface by less than a pixel.
        const Vec2d now = view.point(place(now_s, u, y)).px;
        const Vec2d then = view.point(place(then_s, u, y)).px;
        const int i = static_cast<int>(now.x);
        const int j = static_cast<int>(now.y);
        if (i < 1 || j < 1 || i >= kWidth - 1 || j >= kHeight - 1 || motion.object(i, j) == 0) {
          continue;
        }
        ++seen;
        // The point whose image is the pixel's center, by Newton steps on (u, y).
        double pu = u;
        double py = y;
        for (int step = 0; step < 20; ++step) {
          const auto image = [&](double a, double b) { return view.point(place(now_s, a, b)).px; };
          constexpr double kStep = 1e-5;
          const Vec2d at = image(pu, py);
          const Vec2d du = image(pu + kStep, py);
          const Vec2d dy = image(pu, py + kStep);
          const double a = (du.x - at.x) / kStep, b = (dy.x - at.x) / kStep;
          const double c = (du.y - at.y) / kStep, d = (dy.y - at.y) / kStep;
          const double ex = i + 0.5 - at.x, ey = j + 0.5 - at.y;
          pu += (d * ex - b * ey) / (a * d - b * c);
          py += (a * ey - c * ex) / (a * d - b * c);
        }
        const Vec2d expected = view.point(place(then_s, pu, py)).px;
        EXPECT_NEAR(motion.other_px(i, j).x, expected.x, 2e-3) << u << ' ' << y;
        EXPECT_NEAR(motion.other_px(i, j).y, expected.y, 2e-3) << u << ' ' << y;
        EXPECT_LT(std::hypot(expected.x - then.x, expected.y - then.y), 3);
      }
    }
    EXPECT_GT(seen, 30);
  }
}

}  // namespace
}  // namespace gazetrace::surface_motion_test
