// SPDX-License-Identifier: Apache-2.0
// A part of a frame against the frame itself, by the formula of a pinhole and pixel by pixel.
#include "pipeline/frame_part.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/motion.hpp"
#include "trace/rays/camera_rays.hpp"

namespace gazetrace::frame_part_test {
namespace {

constexpr int kWidth = 320, kHeight = 200;
constexpr PixelRect kRect{208, 16, 64, 96};

FrameRequest frame_of(ProjectionKind kind) {
  FrameRequest request;
  request.width_px = kWidth;
  request.height_px = kHeight;
  request.camera.projection.kind = kind;
  request.camera.projection.yfov_rad = 1.1;
  request.camera.projection.ymag_m = 3;
  request.camera.pose = look_at({1, 2, 3}, {-4, 1, -2}, {0, 1, 0});
  request.view = view_of_perspective(1.1, kWidth, kHeight);
  return request;
}

CameraRays::Ray ray_at(const FrameRequest& request, double x_px, double y_px, const Vec2f& lens = {}) {
  const CameraRays rays(request.camera, request.height_px);
  return rays.ray(static_cast<float>(x_px - 0.5 * request.width_px), static_cast<float>(y_px - 0.5 * request.height_px),
                  lens, 0);
}

void expect_near(const Vec3f& a, const Vec3f& b) {
  EXPECT_NEAR(a.x, b.x, 2e-6);
  EXPECT_NEAR(a.y, b.y, 2e-6);
  EXPECT_NEAR(a.z, b.z, 2e-6);
}

TEST(FramePart, APinholeSeesWhatItsFormulaSays) {
  FrameRequest frame = frame_of(ProjectionKind::perspective);
  frame.camera.pose = {};
  const FrameRequest part = part_of(frame, kRect);
  const double step = 2 * std::tan(0.55) / kHeight;
  const Vec3d way{step * (kRect.x_px + 10.5 - kWidth / 2.0), -step * (kRect.y_px + 7.5 - kHeight / 2.0), -1};
  expect_near(ray_at(part, 10.5, 7.5).direction, to_float(normalize(way)));
  const Vec3d seen = part.view.direction(10.5, 7.5);
  EXPECT_NEAR(seen.x, way.x, 1e-12);
  EXPECT_NEAR(seen.y, way.y, 1e-12);
  const Vec2d back = part.view.pixel(way);
  EXPECT_NEAR(back.x, 10.5, 1e-9);
  EXPECT_NEAR(back.y, 7.5, 1e-9);
}

TEST(FramePart, RaysAreThoseOfTheFrame) {
  for (const ProjectionKind kind : {ProjectionKind::perspective, ProjectionKind::orthographic}) {
    FrameRequest frame = frame_of(kind);
    for (const double radius_m : {0.0, 0.05}) {
      frame.camera.lens = {radius_m, 4};
      const FrameRequest part = part_of(frame, kRect);
      for (const Vec2d px : {Vec2d{0, 0}, Vec2d{63.5, 0.5}, Vec2d{20.25, 95.5}}) {
        const CameraRays::Ray own = ray_at(part, px.x, px.y, {0.3F, -0.7F});
        const CameraRays::Ray whole = ray_at(frame, kRect.x_px + px.x, kRect.y_px + px.y, {0.3F, -0.7F});
        expect_near(own.direction, whole.direction);
        expect_near(own.origin, whole.origin);
        EXPECT_NEAR(own.cone_spread, whole.cone_spread, 1e-8);
      }
    }
  }
}

TEST(FramePart, PlacesAreFoundWhereTheyAreSeen) {
  for (const ProjectionKind kind : {ProjectionKind::perspective, ProjectionKind::orthographic}) {
    const FrameRequest part = part_of(frame_of(kind), kRect);
    const CameraRays rays(part.camera, part.height_px);
    const CameraRays::Ray ray = rays.ray(5, -30);
    const Vec3f way = ray.origin + ray.direction * 7.0F - rays.origin();
    const Vec2f seen = rays.pixel_of(way);
    EXPECT_NEAR(seen.x, 5, 1e-3);
    EXPECT_NEAR(seen.y, -30, 1e-3);
    const PixelProjection projection(part.camera, part.width_px, part.height_px);
    const Vec2d px = projection.point(to_double(ray.origin + ray.direction * 7.0F)).px;
    EXPECT_NEAR(px.x, 5 + 0.5 * part.width_px, 1e-3);
    EXPECT_NEAR(px.y, -30 + 0.5 * part.height_px, 1e-3);
  }
}

TEST(FramePart, APartOfAPartIsThatOfTheFrame) {
  const FrameRequest frame = frame_of(ProjectionKind::perspective);
  const FrameRequest twice = part_of(part_of(frame, kRect), {16, 32, 32, 32});
  const FrameRequest once = part_of(frame, {kRect.x_px + 16, kRect.y_px + 32, 32, 32});
  expect_near(ray_at(twice, 3.5, 9.5).direction, ray_at(once, 3.5, 9.5).direction);
  EXPECT_NEAR(twice.view.left, once.view.left, 1e-12);
  EXPECT_NEAR(twice.view.top, once.view.top, 1e-12);
}

}  // namespace
}  // namespace gazetrace::frame_part_test
