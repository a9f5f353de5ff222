// SPDX-License-Identifier: Apache-2.0
// The real scenes, against the figures of their own description.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "gazetrace/scene.hpp"

namespace gazetrace::scene_files_test {
namespace {

using ::testing::HasSubstr;

const std::string kScenes = std::string(GAZETRACE_SHARED_DIR) + "/scenes/";

class SharedScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kScenes)) {
      GTEST_SKIP() << kScenes << " is not here";
    }
  }
};

TEST_F(SharedScenes, TrianglesOfTheSmallOnes) {
  struct Row {
    const char* file;
    std::uint64_t triangles;
  };
  for (const Row& row : {Row{"AttenuationTest/AttenuationTest.glb", 232},
                         {"ClearCoatTest/ClearCoatTest.gltf", 37116},
                         {"TextureTransformTest/TextureTransformTest.gltf", 18},
                         {"MorphStressTest/MorphStressTest.gltf", 2412},
                         {"AnimatedMorphCube/AnimatedMorphCube.gltf", 12},
                         {"CesiumMan/CesiumMan.glb", 4672},
                         {"CesiumMilkTruck/CesiumMilkTruck.glb", 2856},
                         {"BoxVertexColors/BoxVertexColors.glb", 12},
                         {"Cameras/Cameras.gltf", 2},
                         {"gen-metal-rough-grid/gen-metal-rough-grid.gltf", 108192},
                         {"gen-emissive-strength/gen-emissive-strength.gltf", 72},
                         {"gen-punctual-lights/gen-punctual-lights.gltf", 2220},
                         {"gen-sheen/gen-sheen.gltf", 33120},
                         {"gen-transmission/gen-transmission.gltf", 35436},
                         {"gen-alpha-modes/gen-alpha-modes.gltf", 10},
                         {"gen-extreme-scales/gen-extreme-scales.gltf", 2232}}) {
    const Scene scene = load_scene(kScenes + "small/" + row.file);
    EXPECT_EQ(summarize(scene).triangles_unique, row.triangles) << row.file;
  }
}

void expect_bounds(const SceneSummary& summary, const Vec3d& low, const Vec3d& high, double tolerance) {
  EXPECT_NEAR(summary.bounds_min.x, low.x, tolerance);
  EXPECT_NEAR(summary.bounds_min.y, low.y, tolerance);
  EXPECT_NEAR(summary.bounds_min.z, low.z, tolerance);
  EXPECT_NEAR(summary.bounds_max.x, high.x, tolerance);
  EXPECT_NEAR(summary.bounds_max.y, high.y, tolerance);
  EXPECT_NEAR(summary.bounds_max.z, high.z, tolerance);
}

TEST_F(SharedScenes, Sponza) {
  const Scene scene = load_scene(kScenes + "sponza/Sponza.gltf");
  const SceneSummary summary = summarize(scene);
  EXPECT_EQ(summary.triangles_unique, 262267U);
  EXPECT_EQ(summary.triangles_instanced, 262267U);
  EXPECT_EQ(summary.geometries, 103U);
  EXPECT_EQ(summary.materials, 25U);
  EXPECT_EQ(summary.instances, 1U);
  EXPECT_GE(summary.vertices, 192812U);  // some are doubled at mirrored seams
  EXPECT_LE(summary.vertices, 192812U + 2000U);
  expect_bounds(summary, {-15.4, -1.0, -9.5}, {14.4, 11.4, 8.8}, 0.051);
  EXPECT_TRUE(scene.warnings.empty());
  // Scale 0.008: units are metres.
  EXPECT_NEAR(length(scene.instances.at(0).to_world.x), 0.008, 1e-9);
  for (const Geometry& geometry : scene.meshes.at(0).geometries) {
    const Material& material = scene.materials.at(static_cast<std::size_t>(geometry.material));
    EXPECT_EQ(geometry.tangents.size(), material.normal_texture.present() ? geometry.positions.size() : 0U);
  }
  const SceneFeatures features = features_of(scene);
  EXPECT_TRUE(features.textures);
  EXPECT_TRUE(features.normal_maps);
  EXPECT_TRUE(features.alpha_mask);
  EXPECT_FALSE(features.instances);
  EXPECT_FALSE(features.punctual_lights);
}

TEST_F(SharedScenes, LostEmpireAndItsThirtyCopies) {
  const Scene scene = load_scene(kScenes + "lost-empire/lost-empire.gltf");
  const SceneSummary one = summarize(scene);
  EXPECT_EQ(one.triangles_unique, 224998U);
  EXPECT_EQ(one.triangles_instanced, 224998U);
  EXPECT_EQ(one.vertices, 449992U);
  EXPECT_EQ(one.materials, 45U);
  expect_bounds(one, {-37, 0, -82}, {38, 49, 83}, 1e-3);
  EXPECT_TRUE(features_of(scene).alpha_blend);
  EXPECT_TRUE(features_of(scene).emissive_triangles);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_TRUE(scene.textures[0].nearest);
  SceneReadOptions anywhere;  // it reads the files of the scene beside it
  anywhere.allow_outside = true;
  const SceneSummary thirty = summarize(load_scene(kScenes + "lost-empire-x30/lost-empire-x30.gltf", anywhere));
  EXPECT_EQ(thirty.triangles_unique, 224998U);
  EXPECT_EQ(thirty.triangles_instanced, 6749940U);
  EXPECT_EQ(thirty.geometry_bytes, one.geometry_bytes);  // instanced, not copied
}

TEST_F(SharedScenes, SanMiguel) {
  const Scene scene = load_scene(kScenes + "san-miguel/san-miguel.gltf");
  const SceneSummary summary = summarize(scene);
  EXPECT_EQ(summary.triangles_unique, 1612183U);
  EXPECT_EQ(summary.triangles_instanced, 9507082U);
  EXPECT_EQ(summary.meshes, 784U);
  EXPECT_EQ(summary.vertices, 1229818U);
  EXPECT_EQ(summary.materials, 291U);
  EXPECT_EQ(scene.cameras.size(), 13U);
  EXPECT_GE(summary.instances, 49846U);
  expect_bounds(summary, {-38, -0.5, -37}, {47, 53.5, 37}, 0.3);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(features_of(scene).layers.transmission);
  EXPECT_FALSE(features_of(scene).layers.volume);
  const auto main_camera = std::find_if(scene.cameras.begin(), scene.cameras.end(), [](const SceneCamera& camera) {
    return length(camera.path.pose_at(0).position_m - Vec3d{27.6, 1.5, 2.42}) < 0.05;
  });
  ASSERT_NE(main_camera, scene.cameras.end());
  const CameraPose pose = main_camera->path.pose_at(0);
  EXPECT_LT(angle_between_rad(rotate(pose.orientation, {0, 0, -1}), Vec3d{26.66, 1.488, 2.17} - Vec3d{27.6, 1.5, 2.42}),
            2 * kRadPerDeg);
}

// Two bottles side by side; the file requires the extension for one of them. Its emissive picture is missing.
TEST_F(SharedScenes, SpecularGlossinessIsConverted) {
  const Scene scene = load_scene(kScenes + "small/SpecGlossVsMetalRough/SpecGlossVsMetalRough.glb");
  EXPECT_TRUE(scene.ignored.empty());
  int converted = 0;
  for (const Material& material : scene.materials) {
    if (material.ior == 0) {
      ++converted;
      EXPECT_EQ(material.metallic, 0);
      EXPECT_TRUE(material.base_color_texture.present());
    }
  }
  EXPECT_EQ(converted, 2);  // a bottle and its label
}

// The Khronos box: a cube of side 1, quantised to 14 bits and packed.
TEST_F(SharedScenes, BoxMeshoptIsABox) {
  const Scene scene = load_scene(kScenes + "small/BoxMeshopt/BoxMeshopt.glb");
  EXPECT_TRUE(scene.warnings.empty());
  const SceneSummary summary = summarize(scene);
  EXPECT_EQ(summary.triangles_unique, 12U);
  EXPECT_EQ(summary.vertices, 24U);
  expect_bounds(summary, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 1e-4);
}

TEST_F(SharedScenes, ExtremeScalesKeepAllButTheFlatInstance) {
  const Scene scene = load_scene(kScenes + "small/gen-extreme-scales/gen-extreme-scales.gltf");
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("'flat_zero_z'"));
  EXPECT_EQ(scene.instances.size(), 7U);
}

TEST_F(SharedScenes, VertexColorsArrive) {
  const Scene scene = load_scene(kScenes + "small/BoxVertexColors/BoxVertexColors.glb");
  EXPECT_TRUE(features_of(scene).vertex_colors);
}

// The scene marks where the tip of its arrow must appear ("Correct") and where it lies untransformed ("Not Supported"),
// as places on a square with uv = (x + 0.5, 0.5 - y).
TEST_F(SharedScenes, TextureTransformTestPutsTheArrowOnItsMark) {
  const Scene scene = load_scene(kScenes + "small/TextureTransformTest/TextureTransformTest.gltf");
  const auto read_at = [&](const char* material_name, double x, double y) {
    for (const Material& material : scene.materials) {
      if (material.name == material_name) {
        const auto& m = material.base_color_texture.transform;
        const double u = x + 0.5;
        const double v = 0.5 - y;
        return Vec2d{m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]};
      }
    }
    return Vec2d{};
  };
  const double tip = 0.5 + 0.2778174593052023;
  const Vec2d rotated = read_at("Rotation", -0.07904822439840126, -0.5162674857624154);
  EXPECT_NEAR(rotated.x, tip, 1e-4);
  EXPECT_NEAR(rotated.y, tip, 1e-4);
  const Vec2d scaled = read_at("Scale", 0.018544972870134853, -0.018544972870134853);
  EXPECT_NEAR(scaled.x, tip, 1e-4);
  EXPECT_NEAR(scaled.y, tip, 1e-4);
  const Vec2d all = read_at("All", -0.07, -0.25);  // placed by hand
  EXPECT_NEAR(all.x, tip, 0.05);
  EXPECT_NEAR(all.y, tip, 0.05);
}

}  // namespace
}  // namespace gazetrace::scene_files_test
