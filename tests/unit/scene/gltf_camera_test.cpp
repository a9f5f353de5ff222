// SPDX-License-Identifier: Apache-2.0
// Cameras and their keyframes against values worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::gltf_camera_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using ::testing::HasSubstr;

Scene load(GltfBuilder& builder) {
  const test::TempFolder folder;
  return load_scene(folder.write("scene.gltf", builder.text()));
}

constexpr std::int64_t at_s(double t_s) {
  return static_cast<std::int64_t>(t_s * 1e9);
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

const json kLens{{"type", "perspective"}, {"perspective", {{"yfov", 0.75}, {"znear", 0.125}}}};

// A camera in node 1 under node 0.
GltfBuilder rig() {
  GltfBuilder builder;
  builder.json["cameras"] = {kLens};
  builder.add_node({{"children", {1}}});
  builder.add_node({{"camera", 0}, {"name", "eye"}}, false);
  return builder;
}

void animate(GltfBuilder& builder, int node, const char* path, const char* interpolation,
             const std::vector<float>& times, const std::vector<float>& values, int components) {
  auto& animations = builder.json["animations"];
  if (animations.empty()) {
    animations.push_back({{"samplers", json::array()}, {"channels", json::array()}});
  }
  auto& animation = animations.back();
  const int input = builder.add(times, 1);
  const int output = builder.add(values, components);
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

const CameraPath& only_path(const Scene& scene) {
  EXPECT_EQ(scene.cameras.size(), 1U);
  return scene.cameras.at(0).path;
}

TEST(Cameras, PerspectiveAndOrthographicKeepTheirLenses) {
  GltfBuilder builder = rig();
  builder.json["cameras"].push_back(
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0.5}, {"zfar", 100}}}});
  builder.add_node({{"camera", 1}, {"translation", {1, 2, 3}}});
  const Scene scene = load(builder);
  ASSERT_EQ(scene.cameras.size(), 2U);
  const auto& flat = scene.cameras[0].name == "eye" ? scene.cameras[1] : scene.cameras[0];
  const auto& eye = scene.cameras[0].name == "eye" ? scene.cameras[0] : scene.cameras[1];
  EXPECT_EQ(eye.path.projection.kind, ProjectionKind::perspective);
  EXPECT_EQ(eye.path.projection.yfov_rad, 0.75);
  EXPECT_EQ(eye.path.projection.near_m, 0.125);
  EXPECT_EQ(eye.path.projection.far_m, 0);
  EXPECT_TRUE(eye.path.is_static);
  EXPECT_EQ(flat.path.projection.kind, ProjectionKind::orthographic);
  EXPECT_EQ(flat.path.projection.ymag_m, 2);
  EXPECT_EQ(flat.path.projection.aspect, 1.5);
  EXPECT_EQ(eye.path.projection.aspect, 0);
  EXPECT_EQ(flat.path.projection.far_m, 100);
  expect_near(flat.path.pose_at(0).position_m, {1, 2, 3});
}

TEST(Cameras, ShiftedLenses) {
  GltfBuilder builder = rig();
  builder.json["cameras"][0]["extras"]["gazetrace"]["middle_m"] = {0.25, -0.5};
  EXPECT_EQ(only_path(load(builder)).projection.middle_m, (Vec2d{0.25, -0.5}));
  builder.json["cameras"][0]["extras"]["gazetrace"]["middle_m"] = {0.25, 1e300};
  EXPECT_THAT([&] { load(builder); }, testing::ThrowsMessage<Error>(HasSubstr("cameras[0].extras.gazetrace.middle_m")));
}

TEST(Cameras, ScaledAndMirroredParentsLeaveARotation) {
  GltfBuilder builder = rig();
  const double h = std::sqrt(0.5);
  builder.json["nodes"][0]["scale"] = {-2, 3, 0.5};
  builder.json["nodes"][1]["rotation"] = {0, h, 0, h};
  builder.json["nodes"][1]["translation"] = {1, 1, 1};
  const Scene scene = load(builder);
  const CameraPose pose = only_path(scene).pose_at(0);
  expect_near(pose.position_m, {-2, 3, 0.5});
  expect_near(rotate(pose.orientation, {0, 0, -1}), {1, 0, 0});  // -x mirrored
  expect_near(rotate(pose.orientation, {0, 1, 0}), {0, 1, 0});
}

TEST(Cameras, AZeroScaleKeepsTheDirection) {
  GltfBuilder builder = rig();
  const double h = std::sqrt(0.5);
  builder.json["nodes"][0]["scale"] = {0, 0, 0};
  builder.json["nodes"][1]["rotation"] = {0, h, 0, h};
  const Scene scene = load(builder);
  expect_near(rotate(only_path(scene).pose_at(0).orientation, {0, 0, -1}), {-1, 0, 0});
}

TEST(CameraAnimation, StepLinearAndTheEnds) {
  for (const bool step : {true, false}) {
    GltfBuilder builder = rig();
    animate(builder, 1, "translation", step ? "STEP" : "LINEAR", {1, 2, 4}, {0, 0, 0, 10, 0, 0, 10, 20, 0}, 3);
    const Scene scene = load(builder);
    const CameraPath& path = only_path(scene);
    EXPECT_FALSE(path.is_static);
    EXPECT_EQ(path.begin_ns, at_s(1));
    EXPECT_EQ(path.end_ns, at_s(4));
    expect_near(path.pose_at(at_s(0)).position_m, {0, 0, 0});
    expect_near(path.pose_at(at_s(1.25)).position_m, step ? Vec3d{0, 0, 0} : Vec3d{2.5, 0, 0});
    expect_near(path.pose_at(at_s(2)).position_m, {10, 0, 0});
    expect_near(path.pose_at(at_s(3)).position_m, step ? Vec3d{10, 0, 0} : Vec3d{10, 10, 0});
    expect_near(path.pose_at(at_s(4)).position_m, {10, 20, 0});
    expect_near(path.pose_at(at_s(9)).position_m, {10, 20, 0});
  }
}

TEST(CameraAnimation, LinearRotationsTurnAtConstantSpeedTheShortWay) {
  GltfBuilder builder = rig();
  const auto about_y = [](double deg, double sign = 1) {
    return std::vector<float>{0, static_cast<float>(sign * std::sin(deg * kRadPerDeg / 2)), 0,
                              static_cast<float>(sign * std::cos(deg * kRadPerDeg / 2))};
  };
  std::vector<float> keys = about_y(0);
  const std::vector<float> end = about_y(100, -1);  // the same rotation with the other sign
  keys.insert(keys.end(), end.begin(), end.end());
  animate(builder, 1, "rotation", "LINEAR", {0, 1}, keys, 4);
  const Scene scene = load(builder);
  for (const double t : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    const Vec3d x = rotate(only_path(scene).pose_at(at_s(t)).orientation, {1, 0, 0});
    EXPECT_NEAR(std::atan2(-x.z, x.x) * kDegPerRad, 100 * t, 1e-5) << t;
  }
}

// glTF 2.0 appendix C.4 with t_d = 2 s: u = 1/4 gives (0.84375, 0.15625) for the points and
// 2 * (0.140625, -0.046875) for out-tangent and in-tangent.
TEST(CameraAnimation, CubicSplineHasTheSpecifiedValues) {
  GltfBuilder builder = rig();
  animate(builder, 1, "translation", "CUBICSPLINE", {1, 3},
          {/*in*/ 9, 9, 9, /*value*/ 1, 0, 0, /*out*/ 4, 2, 0, /*in*/ 0, 8, 0, /*value*/ 5, 0, 2, /*out*/ 9, 9, 9}, 3);
  const Scene scene = load(builder);
  const CameraPath& path = only_path(scene);
  expect_near(path.pose_at(at_s(1)).position_m, {1, 0, 0});
  expect_near(path.pose_at(at_s(3)).position_m, {5, 0, 2});
  expect_near(path.pose_at(at_s(1.5)).position_m,
              {0.84375 * 1 + 0.15625 * 5 + 0.28125 * 4, 0.28125 * 2 - 0.09375 * 8, 0.15625 * 2});
  expect_near(path.pose_at(at_s(2)).position_m, {3 + 0.25 * 4, 0.25 * 2 - 0.25 * 8, 1});
  expect_near(path.pose_at(at_s(0)).position_m, {1, 0, 0});
  expect_near(path.pose_at(at_s(7)).position_m, {5, 0, 2});
}

TEST(CameraAnimation, CubicSplineRotationsAreNormalized) {
  GltfBuilder builder = rig();
  const float h = static_cast<float>(std::sqrt(0.5));
  animate(builder, 1, "rotation", "CUBICSPLINE", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,  //
                                                          0, 0, 0, 0, 0, h, 0, h, 0, 0, 0, 0},
          4);
  const Scene scene = load(builder);
  const Quatd q = only_path(scene).pose_at(at_s(0.5)).orientation;
  EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-12);
  EXPECT_NEAR(2 * std::atan2(q.y, q.w) * kDegPerRad, 45, 1e-4);  // by symmetry
}

TEST(CameraAnimation, ParentsMoveTheCameraToo) {
  GltfBuilder builder = rig();
  const float h = static_cast<float>(std::sqrt(0.5));
  builder.json["nodes"][1]["translation"] = {1, 0, 0};
  animate(builder, 0, "rotation", "LINEAR", {0, 2}, {0, 0, 0, 1, 0, h, 0, h}, 4);
  animate(builder, 0, "scale", "STEP", {0, 3}, {1, 1, 1, 2, 2, 2}, 3);
  const Scene scene = load(builder);
  const CameraPath& path = only_path(scene);
  EXPECT_EQ(path.end_ns, at_s(3));
  const double c = std::cos(kPi / 4);
  expect_near(path.pose_at(at_s(1)).position_m, {c, 0, -c});
  expect_near(path.pose_at(at_s(2)).position_m, {0, 0, -1});
  expect_near(path.pose_at(at_s(3)).position_m, {0, 0, -2});
  expect_near(rotate(path.pose_at(at_s(2)).orientation, {0, 0, -1}), {-1, 0, 0});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(CameraAnimation, ThePathOutlivesTheScene) {
  CameraPath path;
  {
    GltfBuilder builder = rig();
    animate(builder, 1, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0}, 3);
    path = only_path(load(builder));
  }
  expect_near(path.pose_at(at_s(0.5)).position_m, {0.5, 0, 0});
}

TEST(CameraAnimation, MotionOfAMeshDoesNotMoveTheCamera) {
  GltfBuilder builder = rig();
  builder.add_triangle();
  animate(builder, 2, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0}, 3);
  builder.json["animations"][0]["name"] = "walk";
  const Scene scene = load(builder);
  EXPECT_TRUE(only_path(scene).is_static);
  EXPECT_EQ(scene.animations, std::vector<std::string>{"walk"});
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.ignored.empty());
}

}  // namespace
}  // namespace gazetrace::gltf_camera_test
