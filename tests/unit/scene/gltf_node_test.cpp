// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/scene.hpp"
#include "gazetrace/scene_contents.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::gltf_node_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using ::testing::HasSubstr;

Scene load(GltfBuilder& builder) {
  const test::TempFolder folder;
  return load_scene(folder.write("scene.gltf", builder.text()));
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

const double kHalf = std::sqrt(0.5);

TEST(Nodes, MatrixAndTrsOfTheSamePlaceAgree) {
  GltfBuilder builder;
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}});
  // Scale (2, 3, 4), a quarter turn about +y (x to -z, z to x), then (5, 6, 7); written out by hand, column by column.
  builder.add_node(
      {{"mesh", mesh}, {"translation", {5, 6, 7}}, {"rotation", {0, kHalf, 0, kHalf}}, {"scale", {2, 3, 4}}});
  builder.add_node({{"mesh", mesh}, {"matrix", {0, 0, -2, 0, 0, 3, 0, 0, 4, 0, 0, 0, 5, 6, 7, 1}}});
  const Scene scene = load(builder);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.meshes.size(), 1U);  // shared, not copied
  for (const Instance& instance : scene.instances) {
    expect_near(transform_point(instance.to_world, {1, 0, 0}), {5, 6, 5});
    expect_near(transform_point(instance.to_world, {0, 1, 0}), {5, 9, 7});
    expect_near(transform_point(instance.to_world, {0, 0, 1}), {9, 6, 7});
  }
  EXPECT_TRUE(features_of(scene).instances);
}

TEST(Nodes, DeepHierarchiesAreFollowedInDouble) {
  constexpr int kDepth = 20000;  // a recursive walk would not return
  GltfBuilder builder;
  builder.add_node({{"translation", {1e7, 0, 0}}});
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}});
  for (int i = 1; i < kDepth; ++i) {
    builder.json["nodes"].back()["children"] = {i};
    builder.add_node({{"translation", {0.001, 0, 0}}}, false);
  }
  builder.json["nodes"].back()["mesh"] = mesh;
  const Scene scene = load(builder);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_NEAR(scene.instances[0].to_world.t.x, 1e7 + 0.001 * (kDepth - 1), 1e-4);
}

std::vector<std::string> assets_of(const Scene& scene) {
  std::vector<std::string> assets;
  for (const Instance& instance : scene.instances) {
    assets.push_back(instance.node + " of " + instance.asset);
  }
  return assets;
}

TEST(Nodes, AssetsAreTheOutermostNodes) {
  GltfBuilder builder;
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}});
  builder.add_node({{"name", "table"}, {"children", {1}}});
  builder.add_node({{"name", "frame"}, {"mesh", mesh}, {"children", {2}}}, false);
  builder.add_node({{"mesh", mesh}}, false);
  builder.add_node({{"name", "lamp"}, {"mesh", mesh}});
  EXPECT_THAT(assets_of(load(builder)),
              ::testing::UnorderedElementsAre("frame of table", "#2 of table", "lamp of lamp"));
}

TEST(Nodes, ANodeAroundEverythingIsNoAsset) {
  GltfBuilder builder;
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}});
  builder.add_node({{"name", "Root"}, {"children", {1}}});
  builder.add_node({{"name", "RootNode"}, {"children", {2, 3}}}, false);
  builder.add_node({{"name", "cup"}, {"children", {4}}}, false);
  builder.add_node({{"name", "plate"}, {"mesh", mesh}}, false);
  builder.add_node({{"name", "handle"}, {"mesh", mesh}}, false);
  EXPECT_THAT(assets_of(load(builder)), ::testing::UnorderedElementsAre("handle of cup", "plate of plate"));
}

TEST(Nodes, InstancesWithoutAnInverseAreLeftOutWithOneWarning) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle();
  builder.add_node({{"mesh", mesh}, {"scale", {1, 1, 0}}, {"name", "flat"}});
  builder.add_node({{"mesh", mesh}, {"scale", {0, 0, 0}}});
  builder.add_node({{"mesh", mesh}, {"scale", {1, 1e-30, 1}}});
  builder.add_node({{"mesh", mesh}, {"scale", {1e300, 1e300, 1e300}}});
  builder.add_node({{"mesh", mesh}, {"scale", {-1, 2, 1e-6}}});  // mirrored and thin, but fine
  builder.add_node({{"mesh", mesh}, {"scale", {1e-6, 1e-6, 1e-6}}});
  const Scene scene = load(builder);
  EXPECT_EQ(scene.instances.size(), 3U);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("4 instances are left out"));
  EXPECT_THAT(scene.warnings[0], HasSubstr("'flat'"));
}

json animation_of(GltfBuilder& builder, int node, const std::vector<float>& times_s) {
  const int input = builder.add(times_s, 1);
  const int output = builder.add(std::vector<float>(3 * times_s.size(), 0.5F), 3);
  return {{{"samplers", {{{"input", input}, {"output", output}}}},
           {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}}}};
}

TEST(Nodes, KeysThatLieFurtherApartThanTimeReachesAreRefused) {
  const test::TempFolder folder;
  for (const auto& [first_s, refused] : {std::pair{-9e9F, true}, std::pair{-4e9F, false}}) {
    GltfBuilder builder;
    builder.add_triangle();
    builder.json["animations"] = animation_of(builder, 0, {first_s, -first_s});
    const std::string path = folder.write("long.gltf", builder.text());
    if (refused) {
      EXPECT_THAT(test::error_of(path), HasSubstr("s is out of range"));
    } else {
      const Scene scene = load_scene(path);
      EXPECT_EQ(scene.motions.at(0).to_world_at(0).t, (Vec3d{0.5, 0.5, 0.5}));
    }
  }
}

// Every node keeps the transforms of its parents where one of them moves: of a chain, half the square of its length.
TEST(Nodes, MovingChainsAreReckonedBeforeTheyAreMade) {
  GltfBuilder builder;
  builder.add_triangle();
  const int count = 4000;
  for (int i = 1; i <= count; ++i) {
    json node = {{"mesh", 0}};
    if (i < count) {
      node["children"] = {i + 1};
    }
    builder.add_node(node, i == 1);
  }
  builder.json["animations"] = animation_of(builder, 1, {0, 1});
  const test::TempFolder folder;
  SceneReadOptions options;
  options.memory_bytes = std::uint64_t{512} << 20U;
  try {
    static_cast<void>(load_scene(folder.write("chain.gltf", builder.text()), options));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("raise `max-memory`"));
  }
}

TEST(Nodes, OnlyTheDefaultSceneIsShown) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle();
  builder.add_node({{"mesh", mesh}}, false);
  builder.json["scenes"].push_back({{"nodes", {1}}});
  builder.json["scene"] = 1;
  const Scene scene = load(builder);
  EXPECT_EQ(scene.instances.size(), 1U);
  EXPECT_THAT(scene.ignored.at(0), HasSubstr("1 scenes besides the default"));
}

TEST(Nodes, WithoutScenesAllParentlessNodesAreShown) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle();
  builder.add_node({{"mesh", mesh}, {"children", {2}}});
  builder.add_node({{"mesh", mesh}}, false);
  builder.json.erase("scenes");
  builder.json.erase("scene");
  EXPECT_EQ(load(builder).instances.size(), 3U);
}

TEST(GpuInstancing, PlacesTheMeshByTranslationRotationScale) {
  GltfBuilder builder;
  builder.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const int mesh = builder.add_triangle();
  const json attributes{{"TRANSLATION", builder.add<float>({1, 0, 0, 0, 2, 0}, 3)},
                        {"ROTATION", builder.add<std::int8_t>({0, 0, 0, 127, 0, 127, 0, 0}, 4, true)},
                        {"SCALE", builder.add<float>({1, 1, 1, 2, 2, 2}, 3)},
                        {"_ID", builder.add<std::uint16_t>({7, 8}, 1)}};
  builder.json["nodes"][0] = {{"mesh", mesh},
                              {"translation", {10, 0, 0}},
                              {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}};
  const Scene scene = load(builder);
  ASSERT_EQ(scene.instances.size(), 2U);
  expect_near(transform_point(scene.instances[0].to_world, {1, 0, 0}), {12, 0, 0});
  // Half a turn about y, twice the size, two up.
  expect_near(transform_point(scene.instances[1].to_world, {1, 1, 0}), {8, 4, 0}, 1e-6);
  EXPECT_TRUE(scene.warnings.empty());
}

json with_lights(const json& lights) {
  return {{"KHR_lights_punctual", {{"lights", lights}}}};
}
json light_node(int light, json node = json::object()) {
  node["extensions"] = {{"KHR_lights_punctual", {{"light", light}}}};
  return node;
}

TEST(Lights, KeepTheirIntensityUnderScaleAndFollowTheirNode) {
  GltfBuilder builder;
  builder.json["extensions"] =
      with_lights({{{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}, {"range", 3}, {"name", "bulb"}},
                   {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
                   {{"type", "directional"}, {"intensity", 2}}});
  const int parent = builder.add_node({{"scale", {0.01, 0.01, 0.01}}, {"translation", {1, 2, 3}}, {"children", {1}}});
  EXPECT_EQ(parent, 0);
  builder.add_node(light_node(0, {{"translation", {100, 0, 0}}}), false);
  builder.add_node(light_node(1, {{"rotation", {0, kHalf, 0, kHalf}}}));                         // -z turns to -x
  builder.add_node(light_node(2, {{"rotation", {-kHalf, 0, 0, kHalf}}, {"scale", {0, 0, 0}}}));  // -z turns to -y
  const Scene scene = load(builder);
  ASSERT_EQ(scene.lights.size(), 3U);
  const auto find = [&](LightKind kind) {
    return *std::find_if(scene.lights.begin(), scene.lights.end(), [&](const auto& l) { return l.kind == kind; });
  };
  const PunctualLight point = find(LightKind::point);
  EXPECT_EQ(point.name, "bulb");
  EXPECT_EQ(point.intensity, (Vec3f{8, 4, 2}));
  EXPECT_EQ(point.range_m, 3);
  expect_near(point.position_m, {2, 2, 3}, 1e-6);
  const PunctualLight spot = find(LightKind::spot);
  expect_near(to_double(spot.direction), {-1, 0, 0}, 1e-6);
  EXPECT_NEAR(spot.cos_inner, std::cos(0.25), 1e-7);
  EXPECT_NEAR(spot.cos_outer, std::cos(0.5), 1e-7);
  const PunctualLight sun = find(LightKind::directional);
  expect_near(to_double(sun.direction), {0, -1, 0}, 1e-6);  // its node has no scale left to turn a vector with
  EXPECT_EQ(sun.intensity, (Vec3f{2, 2, 2}));
}

TEST(Lights, DefaultsAreThoseOfTheExtension) {
  GltfBuilder builder;
  builder.json["extensions"] = with_lights({{{"type", "spot"}, {"spot", json::object()}}});
  builder.add_node(light_node(0));
  const Scene scene = load(builder);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].intensity, (Vec3f{1, 1, 1}));
  EXPECT_EQ(scene.lights[0].cos_inner, 1.0F);
  EXPECT_NEAR(scene.lights[0].cos_outer, kHalf, 1e-7);
  EXPECT_EQ(scene.lights[0].direction, (Vec3f{0, 0, -1}));
}

// CESIUM_RTC: the offset is that of bodies, cameras and lights alike, also of those that animations move.
TEST(Nodes, TheOffsetOfCesiumRtcMovesEverything) {
  GltfBuilder builder;
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}});
  builder.add_node({{"mesh", mesh}, {"translation", {1, 0, 0}}});
  builder.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  builder.add_node({{"camera", 0}, {"translation", {0, 0, 4}}});
  builder.json["extensionsUsed"] = {"CESIUM_RTC"};
  builder.json["extensionsRequired"] = {"CESIUM_RTC"};
  builder.json["extensions"] = {{"CESIUM_RTC", {{"center", {10, 20, -30}}}}};
  Scene scene = load(builder);
  ASSERT_EQ(scene.instances.size(), 1U);
  expect_near(scene.instances[0].to_world.t, {11, 20, -30});
  ASSERT_EQ(scene.cameras.size(), 1U);
  expect_near(scene.cameras[0].path.pose_at(0).position_m, {10, 20, -26});
  EXPECT_THAT(scene.warnings, ::testing::IsEmpty());

  builder.json["extensions"]["CESIUM_RTC"]["center"] = {4e6, 5e5, 4.8e6};  // on the Earth's surface
  scene = load(builder);
  expect_near(scene.instances[0].to_world.t, {4e6 + 1, 5e5, 4.8e6});
  EXPECT_THAT(scene.warnings, ::testing::IsEmpty()) << "nothing is lost there";
  builder.json["extensions"]["CESIUM_RTC"]["center"] = {1, 2};
  const test::TempFolder folder;
  EXPECT_THAT(test::error_of(folder.write("scene.gltf", builder.text())), HasSubstr("CESIUM_RTC.center"));
}

TEST(SceneContents, NamesWhatMovesAndDeforms) {
  GltfBuilder builder;
  const int positions = builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  const int mesh = builder.add_mesh(
      {{"attributes", {{"POSITION", positions}}}, {"targets", {{{"POSITION", positions}}, {{"POSITION", positions}}}}});
  builder.json["meshes"][0]["name"] = "face";
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"smile", "frown"}}};
  builder.add_node({{"mesh", mesh}});
  builder.json["skins"] = {{{"name", "arm"}, {"joints", {0}}}};
  const int times = builder.add<float>({0.5F, 2.5F}, 1);
  const int places = builder.add<float>({0, 0, 0, 1, 0, 0}, 3);
  const int weights = builder.add<float>({0, 0, 1, 1}, 1);
  builder.json["animations"] = {
      {{"name", "nod"},
       {"samplers", {{{"input", times}, {"output", places}}, {{"input", times}, {"output", weights}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  const test::TempFolder folder;
  const SceneContents contents = read_scene_contents(folder.write("scene.gltf", builder.text()));
  ASSERT_EQ(contents.animations.size(), 1U);
  EXPECT_EQ(contents.animations[0].name, "nod");
  EXPECT_EQ(contents.animations[0].begin_s, 0.5);
  EXPECT_EQ(contents.animations[0].end_s, 2.5);
  EXPECT_EQ(contents.animations[0].nodes, 1U);
  EXPECT_EQ(contents.animations[0].shapes, 1U);
  ASSERT_EQ(contents.skins.size(), 1U);
  EXPECT_EQ(contents.skins[0].name, "arm");
  EXPECT_EQ(contents.skins[0].joints, 1U);
  ASSERT_EQ(contents.morphed.size(), 1U);
  EXPECT_EQ(contents.morphed[0].name, "face");
  EXPECT_THAT(contents.morphed[0].targets, ::testing::ElementsAre("smile", "frown"));
}

}  // namespace
}  // namespace gazetrace::gltf_node_test
