// SPDX-License-Identifier: Apache-2.0
// Skins: two joints whose bend has a closed form, and files that are wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::gltf_skin_test {
namespace {

using namespace test;
using nlohmann::json;

constexpr std::int64_t kSecond = 1'000'000'000;

// A bar along y: a triangle of vertices (0, 1.5, 0), (0.25, 2, 0), (0, 0.5, 0) bound half and half to both joints, to
// the second, to the first. The second joint sits at y = 1 and turns about z by 90 degrees in a second.
struct Bar {
  GltfBuilder builder;
  std::vector<float> weights{0.5F, 0.5F, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  std::vector<std::uint8_t> joints{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  bool animated = true;

  Bar() {
    builder.add_node({{"children", {1}}});                                     // 0: joint 0
    builder.add_node({{"translation", {0, 1, 0}}}, false);                     // 1: joint 1
    builder.add_node({{"mesh", 0}, {"skin", 0}, {"translation", {7, 0, 0}}});  // 2: does not move its skin
    std::vector<float> bind(32, 0);
    for (const std::size_t i : {0, 5, 10, 15}) {
      bind[i] = bind[16 + i] = 1;
    }
    bind[16 + 13] = -1;
    builder.json["skins"] = {{{"joints", {0, 1}}, {"inverseBindMatrices", builder.add<float>(bind, 16)}}};
    builder.add_mesh({{"attributes",
                       {{"POSITION", builder.add<float>({0, 1.5F, 0, 0.25F, 2, 0, 0, 0.5F, 0}, 3)},
                        {"NORMAL", builder.add<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}, 3)}}}});
  }
  json& attributes() { return builder.json["meshes"][0]["primitives"][0]["attributes"]; }

  std::string text() {
    if (!attributes().contains("JOINTS_0")) {
      attributes()["JOINTS_0"] = builder.add(joints, 4);
      attributes()["WEIGHTS_0"] = builder.add(weights, 4);
    }
    if (animated) {
      const float half = std::sqrt(0.5F);
      const int input = builder.add<float>({0, 1}, 1);
      const int output = builder.add<float>({0, 0, 0, 1, 0, 0, half, half}, 4);
      builder.json["animations"] = {
          {{"name", "bend"},
           {"samplers", {{{"input", input}, {"output", output}}}},
           {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}}}};
    }
    return builder.text();
  }
};

Scene load(Bar& bar) {
  const TempFolder folder;
  return load_scene(folder.write("bar.gltf", bar.text()));
}

DeformedVertices shape_at(const Scene& scene, std::int64_t t_ns) {
  const Instance& instance = scene.instances.at(0);
  const Deformation& deformation = scene.deformations.at(static_cast<std::size_t>(instance.deformation));
  return deform(scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries[0], deformation.pose_at(t_ns), {});
}

void expect_near(const Vec3f& value, const Vec3d& expected) {
  EXPECT_NEAR(value.x, expected.x, 2e-6);
  EXPECT_NEAR(value.y, expected.y, 2e-6);
  EXPECT_NEAR(value.z, expected.z, 2e-6);
}

void expect_bent(const Scene& scene, double angle_deg, std::int64_t t_ns) {
  const DeformedVertices shape = shape_at(scene, t_ns);
  const double a = angle_deg * kRadPerDeg;
  const auto turned = [&](double x, double y) {
    return Vec3d{x * std::cos(a) - (y - 1) * std::sin(a), 1 + x * std::sin(a) + (y - 1) * std::cos(a), 0};
  };
  expect_near(shape.positions[0], (Vec3d{0, 1.5, 0} + turned(0, 1.5)) * 0.5);
  expect_near(shape.positions[1], turned(0.25, 2));
  expect_near(shape.positions[2], {0, 0.5, 0});
  // The mean of a rotation and none, in its plane, is the rotation by half the angle, shrunk.
  expect_near(shape.normals[0], {std::cos(a / 2), std::sin(a / 2), 0});
  expect_near(shape.normals[1], {std::cos(a), std::sin(a), 0});
  expect_near(shape.normals[2], {1, 0, 0});
}

TEST(GltfSkin, TwoJointsBend) {
  Bar bar;
  const Scene scene = load(bar);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
  EXPECT_TRUE(scene.ignored.empty());
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.instances[0].to_world, Affine{});
  EXPECT_EQ(scene.instances[0].motion, -1);
  EXPECT_TRUE(features_of(scene).motion);
  EXPECT_EQ(scene.deformations[0].end_ns, kSecond);
  expect_bent(scene, 0, 0);
  expect_bent(scene, 30, kSecond / 3);
  expect_bent(scene, 90, kSecond);
  expect_bent(scene, 90, 5 * kSecond);
}

TEST(GltfSkin, ParentsOfJointsMoveThemAndTheMeshsNodeDoesNot) {
  Bar bar;
  bar.builder.json["nodes"][2].erase("translation");
  bar.builder.json["nodes"][0]["children"] = {1};
  const int root = bar.builder.add_node({{"children", {0}}, {"translation", {0, 0, 3}}, {"scale", {2, 2, 2}}}, false);
  bar.builder.json["scenes"][0]["nodes"] = {root, 2};
  const Scene scene = load(bar);
  expect_near(shape_at(scene, 0).positions[1], {0.5, 4, 3});
  const SceneSummary summary = summarize(scene);
  EXPECT_EQ(summary.bounds_min, (Vec3d{0, 1, 3}));
  EXPECT_EQ(summary.bounds_max, (Vec3d{0.5, 4, 3}));
}

TEST(GltfSkin, NumbersThatAreNoJointsAreRefused) {
  for (const float joint : {1e30F, -1.0F, 4294967296.0F}) {
    Bar bar;
    bar.attributes()["JOINTS_0"] = bar.builder.add<float>({joint, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, 4);
    bar.attributes()["WEIGHTS_0"] = bar.builder.add(bar.weights, 4);
    const TempFolder folder;
    EXPECT_THAT(error_of(folder.write("bar.gltf", bar.text())), ::testing::HasSubstr("vertex 0 follows joint"))
        << joint;
  }
}

TEST(GltfSkin, WithoutInverseBindMatricesTheyAreTheIdentity) {
  Bar bar;
  bar.builder.json["skins"][0].erase("inverseBindMatrices");
  const Scene scene = load(bar);
  expect_near(shape_at(scene, 0).positions[1], {0.25, 3, 0});
}

TEST(GltfSkin, ASecondSetOfJointsCountsToo) {
  Bar bar;
  const auto& b = bar;
  bar.attributes()["JOINTS_0"] = bar.builder.add(b.joints, 4);
  bar.attributes()["WEIGHTS_0"] = bar.builder.add<float>({0.25F, 0.25F, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, 4);
  bar.attributes()["JOINTS_1"] = bar.builder.add<std::uint16_t>({0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0}, 4);
  bar.attributes()["WEIGHTS_1"] = bar.builder.add<float>({0.25F, 0.25F, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0}, 4);
  const Scene scene = load(bar);
  EXPECT_EQ(scene.meshes[0].geometries[0].influences.per_vertex, 8U);
  EXPECT_TRUE(scene.warnings.empty());
  expect_bent(scene, 90, kSecond);
}

TEST(GltfSkin, QuantisedWeightsAreBroughtToASumOfOne) {
  Bar bar;
  bar.attributes()["JOINTS_0"] = bar.builder.add(bar.joints, 4);
  bar.attributes()["WEIGHTS_0"] = bar.builder.add<std::uint8_t>({127, 127, 0, 0, 254, 0, 0, 0, 255, 0, 0, 0}, 4, true);
  const Scene scene = load(bar);
  EXPECT_TRUE(scene.warnings.empty());
  expect_bent(scene, 90, kSecond);
}

TEST(GltfSkin, WeightsFarFromASumOfOneAreToldOf) {
  Bar bar;
  bar.weights = {1, 1, 0, 0, 0.5F, 0, 0, 0, 1, 0, 0, 0};
  const Scene scene = load(bar);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], ::testing::HasSubstr("the joint weights of 2 vertices do not sum to 1"));
  expect_bent(scene, 90, kSecond);
}

TEST(GltfSkin, WhatNeverMovesIsPosedAtLoading) {
  Bar bar;
  bar.animated = false;
  bar.builder.json["nodes"][1]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  const Scene scene = load(bar);
  EXPECT_TRUE(scene.deformations.empty());
  EXPECT_FALSE(features_of(scene).motion);
  EXPECT_EQ(summarize(scene).geometries, 1U);
  const Geometry& geometry = scene.meshes[static_cast<std::size_t>(scene.instances[0].mesh)].geometries[0];
  expect_near(geometry.positions[1], {-1, 1.25, 0});
  expect_near(geometry.normals[1], {0, 1, 0});
  EXPECT_EQ(geometry.influences.per_vertex, 0U) << "kept for nothing";
}

TEST(GltfSkin, MirroringJointsTurnTheTriangles) {
  Bar bar;
  bar.animated = false;
  bar.builder.json["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = load(bar);
  const Geometry& geometry = scene.meshes[static_cast<std::size_t>(scene.instances[0].mesh)].geometries[0];
  EXPECT_EQ(geometry.triangles[0], (std::array<std::uint32_t, 3>{0, 2, 1}));
  expect_near(geometry.positions[1], {-0.25, 2, 0});
  expect_near(geometry.normals[1], {-1, 0, 0});
}

// As three.js and Babylon.js bind it: to the first joint that it names, which stands still here in one case and bends
// in the other.
TEST(GltfSkin, VerticesWithoutWeightsFollowTheirFirstJoint) {
  for (const std::uint8_t joint : {0, 1}) {
    Bar bar;
    bar.weights[8] = 0;
    bar.joints[8] = joint;
    const Scene scene = load(bar);
    EXPECT_THAT(scene.warnings, ::testing::ElementsAre(::testing::HasSubstr("weights of 1 vertices are zero")));
    expect_near(shape_at(scene, kSecond).positions[2], joint == 0 ? Vec3d{0, 0.5, 0} : Vec3d{0.5, 1, 0});
  }
}

// Two triangles in the plane z = 0, one bound to a joint that stands still and one to a joint that mirrors x. For any
// direction along a surface, a mirror takes the bitangent sign * cross(normal, tangent) to its mirror image.
TEST(Deformation, MirrorsJointByJointAndTangentsTurnWithIt) {
  Geometry geometry;
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  geometry.normals.assign(6, {0, 0, 1});
  geometry.tangents.assign(6, {0.6F, 0.8F, 0, 1});
  geometry.triangles = {{0, 1, 2}, {3, 4, 5}};
  geometry.influences = {1, {0, 0, 0, 1, 1, 1}, std::vector<float>(6, 1.0F)};
  MeshPose pose;
  pose.joints = {Affine{}, Affine{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}}};
  for (const bool mirrored_first : {false, true}) {
    std::swap(pose.joints[0], pose.joints[mirrored_first ? 1 : 0]);
    const DeformedVertices shape = deform(geometry, pose, {});
    for (std::size_t t = 0; t < 2; ++t) {
      const bool mirrored = (t == 1) != mirrored_first;
      EXPECT_EQ(shape.is_mirrored(geometry.triangles[t]), mirrored);
      const std::uint32_t vertex = geometry.triangles[t][0];
      expect_near(shape.normals[vertex], {0, 0, 1});
      const Vec4f& tangent = shape.tangents[vertex];
      const Vec3d along{tangent.x, tangent.y, tangent.z};
      const Vec3d across = cross(to_double(shape.normals[vertex]), along) * static_cast<double>(tangent.w);
      expect_near({tangent.x, tangent.y, tangent.z}, {mirrored ? -0.6 : 0.6, 0.8, 0});
      expect_near(to_float(across), {mirrored ? 0.8 : -0.8, 0.6, 0});
    }
  }
}

// Joints 1e7 m out: vertices are exact to the float's step at the size of the mesh, not at that distance.
TEST(GltfSkin, FarOutNoVertexLosesItsPlace) {
  for (const bool animated : {false, true}) {
    Bar bar;
    bar.animated = animated;
    bar.weights = {0.3F, 0.7F, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    bar.builder.json["nodes"][0]["translation"] = {1e7, -3e6, 7e6};
    const Scene scene = load(bar);
    const Instance& instance = scene.instances.at(0);
    const std::vector<Vec3f> positions =
        animated ? shape_at(scene, 0).positions
                 : scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries[0].positions;
    const auto place = [&](std::size_t i) {
      return transform_point(instance.to_world, to_double(positions[i])) - Vec3d{1e7, -3e6, 7e6};
    };
    EXPECT_LT(length(place(0) - Vec3d{0, 1.5, 0}), 1e-6);
    EXPECT_LT(length(place(1) - Vec3d{0.25, 2, 0}), 1e-6);
    EXPECT_LT(length(place(2) - Vec3d{0, 0.5, 0}), 1e-6);
  }
}

TEST(GltfSkin, AnAnimationCanBeChosen) {
  const auto with_two = [] {
    Bar bar;
    bar.text();
    json second = bar.builder.json["animations"][0];
    second["name"] = "stretch";
    second["samplers"][0]["output"] = bar.builder.add<float>({0, 1, 0, 0, 3, 0}, 3);
    second["channels"][0]["target"]["path"] = "translation";
    bar.builder.json["animations"].push_back(second);
    bar.animated = false;
    return bar;
  };
  const TempFolder folder;
  const auto positions = [&](const std::string& animation) {
    Bar bar = with_two();
    SceneReadOptions options;
    options.animation = animation;
    const Scene scene = load_scene(folder.write("two.gltf", bar.text()), options);
    EXPECT_EQ(scene.animations.size(), 2U);
    EXPECT_EQ(scene.warnings.empty(), !animation.empty());
    return shape_at(scene, kSecond).positions[1];
  };
  expect_near(positions(""), {-1, 1.25, 0});
  expect_near(positions("bend"), {-1, 1.25, 0});
  expect_near(positions("stretch"), {0.25, 4, 0});
  expect_near(positions("1"), {0.25, 4, 0});
  try {
    positions("strech");
    FAIL() << "an animation that is not there was found";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("stretch"));
    EXPECT_EQ(error.kind(), ErrorKind::usage);
  }
}

struct BadSkin {
  const char* name;
  std::function<void(Bar&)> spoil;
  const char* message;
};

class GltfSkinErrors : public ::testing::TestWithParam<BadSkin> {};

TEST_P(GltfSkinErrors, SayWhereAndWhat) {
  Bar bar;
  GetParam().spoil(bar);
  try {
    load(bar);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), ::testing::HasSubstr(GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, GltfSkinErrors,
    ::testing::Values(
        BadSkin{"JointOutOfRange", [](Bar& b) { b.joints[1] = 2; },
                "meshes[0]: vertex 0 follows joint 2; the skin of nodes[2] has 2"},
        BadSkin{"NegativeWeight", [](Bar& b) { b.weights[4] = -1; }, "WEIGHTS_0: vertex 1 has a negative weight"},
        BadSkin{"JointsAlone", [](Bar& b) { b.attributes()["JOINTS_0"] = b.builder.add(b.joints, 4); },
                "JOINTS_0 comes without WEIGHTS_0"},
        BadSkin{"TooFewVertices",
                [](Bar& b) {
                  b.attributes()["JOINTS_0"] = b.builder.add<std::uint8_t>({0, 0, 0, 0}, 4);
                  b.attributes()["WEIGHTS_0"] = b.builder.add<float>({1, 0, 0, 0}, 4);
                },
                "JOINTS_0: 1 values for 3 positions"},
        BadSkin{"TooFewMatrices",
                [](Bar& b) {
                  b.builder.json["skins"][0]["inverseBindMatrices"] = b.builder.add<float>(std::vector<float>(16), 16);
                },
                "skins[0].inverseBindMatrices: 1 matrices for 2 joints"},
        BadSkin{"MatricesOfVectors",
                [](Bar& b) { b.builder.json["skins"][0]["inverseBindMatrices"] = b.attributes()["POSITION"]; },
                "has 3 components where 16 are needed"},
        BadSkin{"JointThatIsNoNode",
                [](Bar& b) {
                  b.builder.json["skins"][0]["joints"] = {0, 9};
                },
                "skins[0].joints[1]"},
        BadSkin{"NoJoints", [](Bar& b) { b.builder.json["skins"][0].erase("joints"); }, "skins[0]: has no joints"}),
    [](const auto& test) { return test.param.name; });

TEST(GltfSkin, AMeshWithoutJointsCannotFollowASkin) {
  Bar bar;
  bar.animated = false;
  const TempFolder folder;
  try {
    load_scene(folder.write("bar.gltf", bar.builder.text()));
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("has no JOINTS_0 and WEIGHTS_0, and nodes[2] gives it a skin"));
  }
}

}  // namespace
}  // namespace gazetrace::gltf_skin_test
