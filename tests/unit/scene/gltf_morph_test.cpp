// SPDX-License-Identifier: Apache-2.0
// Morph targets: a quad whose shapes are sums done by hand, its animation, and files that are wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::gltf_morph_test {
namespace {

using namespace test;
using nlohmann::json;

constexpr std::int64_t kSecond = 1'000'000'000;

// A unit quad in the plane z = 0. Target 0 lifts everything by 2 along z; target 1 moves vertex 2 alone by (4, 0, 0),
// stored sparsely.
struct Quad {
  GltfBuilder builder;

  Quad() {
    const int lift = builder.add<float>({0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}, 3);
    builder.add<float>({4, 0, 0}, 3);  // of no use of its own: only its view
    const int values_view = builder.json["accessors"].back()["bufferView"];
    builder.json["accessors"].erase(builder.json["accessors"].size() - 1);
    const int indices_view = builder.add_view({2});
    builder.json["accessors"].push_back({{"componentType", 5126},
                                         {"count", 4},
                                         {"type", "VEC3"},
                                         {"sparse",
                                          {{"count", 1},
                                           {"indices", {{"bufferView", indices_view}, {"componentType", 5121}}},
                                           {"values", {{"bufferView", values_view}}}}}});
    const int pull = static_cast<int>(builder.json["accessors"].size()) - 1;
    const int positions = builder.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    const int normals = builder.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    builder.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                      {"indices", builder.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, 1)},
                      {"targets", {{{"POSITION", lift}}, {{"POSITION", pull}}}}});
    builder.add_node({{"mesh", 0}});
  }
  json& primitive() { return builder.json["meshes"][0]["primitives"][0]; }
  void animate(const std::vector<float>& times, const std::vector<float>& weights, const char* interpolation) {
    const int input = builder.add<float>(times, 1);
    const int output = builder.add<float>(weights, 1);
    builder.json["animations"] = {
        {{"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  }
  Scene load() {
    const TempFolder folder;
    return load_scene(folder.write("quad.gltf", builder.text()));
  }
};

const Geometry& geometry_of(const Scene& scene) {
  return scene.meshes[static_cast<std::size_t>(scene.instances.at(0).mesh)].geometries.at(0);
}

DeformedVertices shape_at(const Scene& scene, double t_s) {
  const auto index = static_cast<std::size_t>(scene.instances.at(0).deformation);
  return deform(geometry_of(scene), scene.deformations.at(index).pose_at(static_cast<std::int64_t>(t_s * 1e9)), {});
}

TEST(GltfMorph, LinearWeightsAddDisplacements) {
  Quad quad;
  quad.animate({0, 1}, {0, 0, 1, 0.5F}, "LINEAR");
  const Scene scene = quad.load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.ignored.empty());
  EXPECT_EQ(scene.deformations.at(0).end_ns, kSecond);
  EXPECT_EQ(shape_at(scene, 0).positions[2], (Vec3f{1, 1, 0}));
  EXPECT_EQ(shape_at(scene, 0.5).positions[2], (Vec3f{2, 1, 1}));
  EXPECT_EQ(shape_at(scene, 0.5).positions[3], (Vec3f{0, 1, 1}));
  EXPECT_EQ(shape_at(scene, 2).positions[2], (Vec3f{3, 1, 2}));
}

TEST(GltfMorph, StepHoldsAndSplinesFollowHermite) {
  Quad step;
  step.animate({0, 1}, {0.25F, 0, 1, 0}, "STEP");
  EXPECT_EQ(shape_at(step.load(), 0.99).positions[0], (Vec3f{0, 0, 0.5F}));
  Quad spline;
  // Two keys 2 s apart, of two weights: in-tangents, values, out-tangents.
  spline.animate({0, 2}, {0, 0, 0, 0, 3, 0, 1, 0, 1, 0, 0, 0}, "CUBICSPLINE");
  // u = 1/4: p1 (3 u^2 - 2 u^3) + 2 s * out0 (u - 2 u^2 + u^3) + 2 s * in1 (u^3 - u^2).
  const double expected = 0.15625 + 2 * 3 * 0.140625 + 2 * 1 * -0.046875;
  EXPECT_NEAR(shape_at(spline.load(), 0.5).positions[0].z, 2 * expected, 1e-6);
}

TEST(GltfMorph, ANodesWeightsGoOverItsMeshsAndAreAppliedAtLoading) {
  Quad quad;
  quad.builder.json["meshes"][0]["weights"] = {0.5, 0};
  EXPECT_EQ(geometry_of(quad.load()).positions[0], (Vec3f{0, 0, 1}));
  Quad node;
  node.builder.json["meshes"][0]["weights"] = {0.5, 0};
  node.builder.json["nodes"][0]["weights"] = {0, 1};
  const Scene scene = node.load();
  EXPECT_TRUE(scene.deformations.empty());
  EXPECT_EQ(geometry_of(scene).positions[0], (Vec3f{0, 0, 0}));
  EXPECT_EQ(geometry_of(scene).positions[2], (Vec3f{5, 1, 0}));
  EXPECT_TRUE(geometry_of(scene).morph_targets.empty()) << "kept for nothing";
}

// glTF 2.0, section 3.7.2.2: what targets add to colours is clamped to 0..1 at the end; without an attribute of its own
// the primitive has nothing to add to.
TEST(GltfMorph, ColoursMorph) {
  Quad quad;
  const auto colors = [&](const std::vector<float>& one) {
    std::vector<float> four;
    for (int i = 0; i < 4; ++i) {
      four.insert(four.end(), one.begin(), one.end());
    }
    return quad.builder.add<float>(four, static_cast<int>(one.size()));
  };
  quad.primitive()["attributes"]["COLOR_0"] = colors({0.5F, 0.25F, 0, 1});
  quad.primitive()["targets"][0]["COLOR_0"] = colors({-1, 0.5F, 0.25F});
  quad.animate({0, 1}, {0, 0, 1, 0}, "LINEAR");
  const Scene scene = quad.load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(shape_at(scene, 0).colors.empty());
  EXPECT_EQ(shape_at(scene, 0.5).colors.at(2), (Vec4f{0, 0.5F, 0.125F, 1}));
  EXPECT_EQ(shape_at(scene, 1).colors.at(2), (Vec4f{0, 0.75F, 0.25F, 1}));

  Quad bare;
  bare.primitive()["targets"][0]["COLOR_0"] = bare.builder.add<float>(std::vector<float>(12, 1.0F), 3);
  bare.builder.json["meshes"][0]["weights"] = {1, 0};
  EXPECT_TRUE(geometry_of(bare.load()).colors.empty());
}

TEST(GltfMorph, TwoNodesShowOneMeshInTwoShapes) {
  Quad quad;
  quad.animate({0, 1}, {0, 0, 1, 0}, "LINEAR");
  quad.builder.add_node({{"mesh", 0}, {"weights", {0.25, 0}}});
  const Scene scene = quad.load();
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.deformations.size(), 1U);
  const Geometry& still = scene.meshes[static_cast<std::size_t>(scene.instances[1].mesh)].geometries[0];
  EXPECT_EQ(still.positions[0], (Vec3f{0, 0, 0.5F}));
  EXPECT_EQ(shape_at(scene, 1).positions[0], (Vec3f{0, 0, 2}));
}

TEST(GltfMorph, NormalsMorphAndKeepTheirLength) {
  Quad quad;
  quad.primitive()["targets"][0]["NORMAL"] = quad.builder.add<float>({1, 0, -1, 1, 0, -1, 1, 0, -1, 1, 0, -1}, 3);
  quad.animate({0, 1}, {0, 0, 1, 0}, "LINEAR");
  const Scene scene = quad.load();
  const Vec3f half = shape_at(scene, 0.5).normals[0];
  EXPECT_NEAR(half.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(half.z, std::sqrt(0.5), 1e-6);
  EXPECT_EQ(shape_at(scene, 1).normals[3], (Vec3f{1, 0, 0}));
}

TEST(GltfMorph, FlatNormalsFollowTheShape) {
  Quad quad;
  quad.primitive()["attributes"].erase("NORMAL");
  // Lifts the edge y = 1 by 1: the quad leans by 45 degrees.
  quad.primitive()["targets"] = {{{"POSITION", quad.builder.add<float>({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1}, 3)}}};
  quad.animate({0, 1}, {0, 1}, "LINEAR");
  const Scene scene = quad.load();
  EXPECT_EQ(geometry_of(scene).positions.size(), 6U);
  for (const Vec3f& normal : shape_at(scene, 1).normals) {
    EXPECT_NEAR(normal.y, -std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(normal.z, std::sqrt(0.5), 1e-6);
  }
}

TEST(GltfMorph, TangentsThatTheFileLacksFollowTheShape) {
  Quad quad;
  quad.primitive()["attributes"]["TEXCOORD_0"] = quad.builder.add<float>({0, 1, 1, 1, 1, 0, 0, 0}, 2);
  quad.primitive()["material"] = 0;
  quad.builder.json["images"] = {{{"uri",
                                   "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4"
                                   "2mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=="}}};
  quad.builder.json["textures"] = {{{"source", 0}}};
  quad.builder.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
  // Turns the quad about z by 90 degrees: (x, y) to (-y, x).
  quad.primitive()["targets"] = {{{"POSITION", quad.builder.add<float>({0, 0, 0, -1, 1, 0, -2, 0, 0, -1, -1, 0}, 3)}}};
  quad.animate({0, 1}, {0, 1}, "LINEAR");
  const Scene scene = quad.load();
  const TextureRef texture = scene.materials[0].normal_texture;
  const auto tangent_at = [&](std::int64_t t_ns) {
    return deform(geometry_of(scene), scene.deformations[0].pose_at(t_ns), texture).tangents.at(0);
  };
  EXPECT_NEAR(tangent_at(0).x, 1, 1e-6);
  EXPECT_NEAR(tangent_at(kSecond).y, 1, 1e-6);
  EXPECT_EQ(tangent_at(0).w, tangent_at(kSecond).w);
}

struct BadMorph {
  const char* name;
  std::function<void(Quad&)> spoil;
  const char* message;
};

class GltfMorphErrors : public ::testing::TestWithParam<BadMorph> {};

TEST_P(GltfMorphErrors, SayWhereAndWhat) {
  Quad quad;
  GetParam().spoil(quad);
  try {
    quad.load();
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), ::testing::HasSubstr(GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, GltfMorphErrors,
    ::testing::Values(BadMorph{"NoAccessor", [](Quad& q) { q.primitive()["targets"][1]["POSITION"] = 99; },
                               "meshes[0].primitives[0].targets[1].POSITION: 99 is not an index into"},
                      BadMorph{"TooFewVertices",
                               [](Quad& q) {
                                 q.primitive()["targets"][0]["POSITION"] = q.builder.add<float>({0, 0, 1}, 3);
                               },
                               "targets[0].POSITION: 1 values for 4 positions"},
                      BadMorph{"UnlikePrimitives",
                               [](Quad& q) {
                                 q.builder.json["meshes"][0]["primitives"].push_back(q.primitive());
                                 q.builder.json["meshes"][0]["primitives"][1].erase("targets");
                               },
                               "has 0 morph targets, the primitives before it have 2"},
                      BadMorph{"WeightsOfTheMesh", [](Quad& q) { q.builder.json["meshes"][0]["weights"] = {1}; },
                               "meshes[0].weights: is not an array of 2 numbers"},
                      BadMorph{"WeightsOfTheNode", [](Quad& q) { q.builder.json["nodes"][0]["weights"] = {1}; },
                               "nodes[0].weights: 1 weights for 2 morph targets"},
                      BadMorph{"TooFewKeys",
                               [](Quad& q) {
                                 q.animate({0, 1}, {0, 1}, "LINEAR");
                               },
                               "animations[0].samplers[0].output: 2 values for 2 keys, 4 are needed"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace gazetrace::gltf_morph_test
