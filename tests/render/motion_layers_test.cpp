// SPDX-License-Identifier: Apache-2.0
// Motion vectors against finite differences of world positions: the place that a pixel shows is carried to the frame
// before and after by the body's own motion, written down a second time, and projected by the camera of that time.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

#include "gazetrace/frame_renderer.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace::motion_layers_test {
namespace {

using namespace test;

constexpr int kWidth = 96, kHeight = 64;
constexpr double kRate = 24;

double seconds(std::int64_t t_ns) {
  return static_cast<double>(t_ns) * 1e-9;
}

// The three motions, from a point at rest to the world, and back.
struct Way {
  std::function<Vec3d(const Vec3d&, double)> to_world, to_rest;
};

Vec3d turned(const Vec3d& p, double angle) {  // about z
  return {p.x * std::cos(angle) - p.y * std::sin(angle), p.x * std::sin(angle) + p.y * std::cos(angle), p.z};
}

// A body that turns and flies by, another that a joint bends away from its place, and one whose sides swell.
const Way kMoving{[](const Vec3d& p, double s) {
                    return turned(p, s) + Vec3d{-3 + s, 0.2, 0.5 * s};
                  },
                  [](const Vec3d& p, double s) {
                    return turned(p - Vec3d{-3 + s, 0.2, 0.5 * s}, -s);
                  }};
const Way kSkinned{[](const Vec3d& p, double s) {
                     return turned(p, -2 * s) + Vec3d{0, -0.5 * s, 0};
                   },
                   [](const Vec3d& p, double s) {
                     return turned(p - Vec3d{0, -0.5 * s, 0}, 2 * s);
                   }};
const Way kMorphing{[](const Vec3d& p, double s) {
                      return Vec3d{3 + (p.x - 3) * (1 + s), p.y, p.z + s * p.y};
                    },
                    [](const Vec3d& p, double s) {
                      return Vec3d{3 + (p.x - 3) / (1 + s), p.y, p.z - s * p.y};
                    }};

Scene bodies() {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  const auto square = [](float x) { return quad({{{x - 1, -1, 0}, {x + 1, -1, 0}, {x + 1, 1, 0}, {x - 1, 1, 0}}}, 0); };
  add_mesh(scene, {square(0)});
  scene.motions.push_back({[](std::int64_t t) {
    const double s = seconds(t);
    return make_affine({-3 + s, 0.2, 0.5 * s}, {0, 0, std::sin(s / 2), std::cos(s / 2)}, {1, 1, 1});
  }});
  scene.instances[0].motion = 0;

  Geometry skinned = square(0);
  skinned.influences = {1, {0, 0, 0, 0}, {1, 1, 1, 1}};
  add_mesh(scene, {skinned});
  Deformation joint;
  joint.pose_at = [](std::int64_t t) {
    const double s = seconds(t);
    return MeshPose{{}, {make_affine({0, -0.5 * s, 0}, {0, 0, std::sin(-s), std::cos(-s)}, {1, 1, 1})}};
  };
  joint.rest = joint.pose_at(0);
  scene.deformations.push_back(joint);
  scene.instances[1].deformation = 0;

  Geometry morphing = square(3);
  MorphTarget wider;
  wider.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  morphing.morph_targets.push_back(wider);
  add_mesh(scene, {morphing});
  Deformation swelling;
  swelling.pose_at = [](std::int64_t t) { return MeshPose{{seconds(t)}, {}}; };
  swelling.rest = swelling.pose_at(0);
  scene.deformations.push_back(swelling);
  scene.instances[2].deformation = 1;
  return scene;
}

Camera camera_then(double s) {
  return camera_at({0.5 * s, 0.3, 9}, {0.2 * s, 0, 0});
}

// The pixel of a point of the world, written a second time: pinhole, square pixels, y down.
Vec2d project(const Vec3d& p, const Camera& camera) {
  const Vec3d way = p - camera.pose.position_m;
  const double depth = dot(way, rotate(camera.pose.orientation, {0, 0, -1}));
  const double focal_px = kHeight / 2.0 / std::tan(camera.projection.yfov_rad / 2);
  return {kWidth / 2.0 + focal_px * dot(way, rotate(camera.pose.orientation, {1, 0, 0})) / depth,
          kHeight / 2.0 - focal_px * dot(way, rotate(camera.pose.orientation, {0, 1, 0})) / depth};
}

TEST(MotionLayers, AreFiniteDifferencesOfPlaces) {
  const Scene scene = bodies();
  PathTracer tracer(scene, threads(2));
  FrameSettings settings;
  settings.foveation.spp = 1;
  settings.reconstruction.filter = "none";
  settings.layers.forward = settings.layers.backward = settings.layers.position = true;
  FrameRequest request;
  const double now_s = 0.3;
  const auto at = [](double s) { return std::llround(s * 1e9); };
  request.t_video_ns = request.shutter_open_ns = request.shutter_close_ns = at(now_s);
  request.width_px = kWidth;
  request.height_px = kHeight;
  request.camera = camera_then(now_s);
  request.view = view_of_perspective(50 * kRadPerDeg, kWidth, kHeight);
  request.before = {camera_then(now_s - 1 / kRate).pose, at(now_s - 1 / kRate)};
  request.after = {camera_then(now_s + 1 / kRate).pose, at(now_s + 1 / kRate)};
  const RenderedFrame rendered = FrameRenderer(tracer, settings).render(request);
  const MotionLayers& layers = rendered.layers.motion;
  const PosedScene posed = tracer.at({request.t_video_ns, request.t_video_ns});
  const SurfaceMotion seen = posed.surface_motion(request.camera, kWidth, kHeight, {request.camera, at(now_s)});
  const std::array<const Way*, 3> ways{&kMoving, &kSkinned, &kMorphing};
  const std::array<const char*, 3> names{"moving", "skinned", "morphing"};
  std::array<double, 3> worst{};
  std::array<Vec2d, 3> worst_px{};
  std::array<int, 3> pixels{};
  double longest = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::uint32_t object = seen.object(x, y);
      if (object == 0) {
        EXPECT_EQ(layers.position_m(x, y), Vec3f());
        continue;
      }
      const Vec3d place = to_double(layers.position_m(x, y));
      const Vec2d own = project(place, request.camera);
      EXPECT_NEAR(own.x, x + 0.5, 1e-4);  // the place is what the pixel's centre shows
      EXPECT_NEAR(own.y, y + 0.5, 1e-4);
      const Way& way = *ways[object - 1];
      const Vec3d at_rest = way.to_rest(place, now_s);
      for (const bool forwards : {true, false}) {
        const double then_s = now_s + (forwards ? 1 : -1) / kRate;
        const Vec2d then = project(way.to_world(at_rest, then_s), camera_then(then_s));
        const Vec2f vector = forwards ? layers.forward_px(x, y) : layers.backward_px(x, y);
        const double off = std::hypot(static_cast<double>(vector.x) - (then.x - own.x),
                                      static_cast<double>(vector.y) + (then.y - own.y));  // v points up
        if (off > worst[object - 1]) {
          worst[object - 1] = off;
          worst_px[object - 1] = {x + 0.5, y + 0.5};
        }
        longest = std::max(longest, std::hypot(then.x - own.x, then.y - own.y));
      }
      ++pixels[object - 1];
    }
  }
  for (std::size_t body = 0; body < 3; ++body) {
    std::cout << names[body] << ": " << pixels[body] << " pixels, worst " << worst[body] << " px at "
              << worst_px[body].x << ", " << worst_px[body].y << '\n';
    EXPECT_GT(pixels[body], 100);
    EXPECT_LT(worst[body], 1e-3);
  }
  EXPECT_GT(longest, 0.5);
}

TEST(MotionLayers, TheSkyTurnsWithTheCameraAndWhatIsBehindItHasNoMotion) {
  const Scene scene = bodies();
  PathTracer tracer(scene, threads(1));
  FrameSettings settings;
  settings.foveation.spp = 1;
  settings.reconstruction.filter = "none";
  settings.layers.forward = settings.layers.backward = true;
  FrameRequest request;
  request.width_px = kWidth;
  request.height_px = kHeight;
  request.camera = camera_at({0, 0, 99}, {0, 0, 200});
  request.view = view_of_perspective(50 * kRadPerDeg, kWidth, kHeight);
  request.before.pose = camera_at({0, 0, 99}, {0, 0, 0}).pose;  // looked the other way
  // Turned up: the sky moves down.
  request.after.pose = camera_at({0, 0, 99}, {0, 1, 199}).pose;
  const MotionLayers layers = FrameRenderer(tracer, settings).render(request).layers.motion;
  const double focal_px = kHeight / 2.0 / std::tan(25 * kRadPerDeg);
  EXPECT_NEAR(static_cast<double>(layers.forward_px(kWidth / 2, kHeight / 2).y), -focal_px * 0.01, 0.01);
  EXPECT_EQ(layers.backward_px(kWidth / 2, kHeight / 2), Vec2f());
}

}  // namespace
}  // namespace gazetrace::motion_layers_test
