// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::gltf_material_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::PngColor;
using ::testing::HasSubstr;

std::string data_uri(const std::vector<std::uint8_t>& png) {
  return "data:image/png;base64," + test::base64(png);
}
std::vector<std::uint8_t> pixel(std::uint16_t r, std::uint16_t g, std::uint16_t b) {
  return test::png_bytes(1, 1, PngColor::rgb, 8, {r, g, b});
}

// A triangle with the given material and images.
GltfBuilder with_material(const json& material, const json& images = json::array(),
                          const json& samplers = json::array()) {
  GltfBuilder builder;
  builder.json["materials"] = {material};
  builder.json["images"] = images;
  if (!samplers.empty()) {
    builder.json["samplers"] = samplers;
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    json texture{{"source", i}};
    if (i < samplers.size()) {
      texture["sampler"] = i;
    }
    builder.json["textures"].push_back(texture);
  }
  json primitive{{"material", 0}};
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_1"}) {
    primitive["attributes"][set] = builder.add<float>({0, 0, 1, 0, 0, 1}, 2);
  }
  builder.add_triangle(primitive);
  return builder;
}

Scene load(GltfBuilder& builder) {
  const test::TempFolder folder;
  return load_scene(folder.write("scene.gltf", builder.text()));
}

TEST(Materials, DefaultsAreThoseOfTheSpecification) {
  GltfBuilder builder = with_material(json::object());
  const Material material = load(builder).materials.at(0);
  EXPECT_EQ(material.base_color, (Vec4f{1, 1, 1, 1}));
  EXPECT_EQ(material.metallic, 1);
  EXPECT_EQ(material.roughness, 1);
  EXPECT_EQ(material.emission, (Vec3f{0, 0, 0}));
  EXPECT_EQ(material.alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(material.alpha_cutoff, 0.5F);
  EXPECT_FALSE(material.double_sided);
  EXPECT_FALSE(material.base_color_texture.present());
}

TEST(Materials, EveryFactorArrives) {
  GltfBuilder builder =
      with_material({{"name", "leaf"},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.75}}},
                     {"emissiveFactor", {1, 0.5, 0}},
                     {"alphaMode", "MASK"},
                     {"alphaCutoff", 0.625},
                     {"doubleSided", true},
                     {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
  const Scene scene = load(builder);
  const Material& material = scene.materials.at(0);
  EXPECT_EQ(material.name, "leaf");
  EXPECT_EQ(material.base_color, (Vec4f{0.1F, 0.2F, 0.3F, 0.4F}));
  EXPECT_EQ(material.metallic, 0.25F);
  EXPECT_EQ(material.roughness, 0.75F);
  EXPECT_EQ(material.emission, (Vec3f{4, 2, 0}));
  EXPECT_EQ(material.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(material.alpha_cutoff, 0.625F);
  EXPECT_TRUE(material.double_sided);
  const SceneFeatures features = features_of(scene);
  EXPECT_TRUE(features.alpha_mask);
  EXPECT_TRUE(features.emissive_triangles);
  EXPECT_FALSE(features.textures);
  EXPECT_FALSE(features.alpha_blend);
  EXPECT_FALSE(features.environment);
  EXPECT_EQ(summarize(scene).emissive_triangles, 1U);
}

TEST(Materials, UnlitReadsNothingButBaseColor) {
  GltfBuilder builder = with_material({{"normalTexture", {{"index", 0}}},
                                       {"emissiveFactor", {1, 1, 1}},
                                       {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}},
                                       {"alphaMode", "BLEND"},
                                       {"extensions", {{"KHR_materials_unlit", json::object()}}}},
                                      {{{"uri", data_uri(pixel(1, 2, 3))}}});
  const Scene scene = load(builder);
  EXPECT_TRUE(scene.materials.at(0).unlit);
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_TRUE(features_of(scene).unlit);
  EXPECT_TRUE(features_of(scene).alpha_blend);
  EXPECT_FALSE(features_of(scene).emissive_triangles);
}

TEST(Materials, AlphaThatLetsNothingThroughIsOpaque) {
  struct Case {
    const char* mode;
    double factor;
    std::uint16_t texel, vertex;
    AlphaMode expected;
  };
  for (const Case& c : {Case{"MASK", 1, 255, 255, AlphaMode::opaque}, Case{"MASK", 0.5, 255, 255, AlphaMode::opaque},
                        Case{"MASK", 0.49, 255, 255, AlphaMode::mask}, Case{"MASK", 1, 254, 255, AlphaMode::mask},
                        Case{"MASK", 1, 255, 254, AlphaMode::mask}, Case{"BLEND", 1, 255, 255, AlphaMode::opaque},
                        Case{"BLEND", 0.99, 255, 255, AlphaMode::blend}, Case{"BLEND", 1, 0, 255, AlphaMode::blend},
                        Case{"BLEND", 1, 255, 0, AlphaMode::blend}, Case{"OPAQUE", 0, 0, 0, AlphaMode::opaque}}) {
    GltfBuilder builder = with_material(
        {{"alphaMode", c.mode},
         {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, c.factor}}, {"baseColorTexture", {{"index", 0}}}}}},
        {{{"uri", data_uri(test::png_bytes(1, 1, PngColor::rgba, 8, {9, 9, 9, c.texel}))}}});
    const auto alpha = static_cast<std::uint8_t>(c.vertex);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        builder.add<std::uint8_t>({9, 9, 9, 255, 9, 9, 9, alpha, 9, 9, 9, 255}, 4, true);
    EXPECT_EQ(load(builder).materials.at(0).alpha_mode, c.expected)
        << c.mode << " " << c.factor << " " << c.texel << " " << c.vertex;
  }
}

TEST(Materials, PrimitivesWithoutOneGetTheDefault) {
  GltfBuilder builder = with_material({{"doubleSided", true}});
  builder.add_triangle();
  const Scene scene = load(builder);
  ASSERT_EQ(scene.materials.size(), 2U);
  EXPECT_EQ(scene.meshes.at(0).geometries.at(0).material, 0);
  EXPECT_EQ(scene.meshes.at(1).geometries.at(0).material, 1);
  EXPECT_FALSE(scene.materials[1].double_sided);
}

Vec2f transformed(const TextureRef& ref, float u, float v) {
  const auto& m = ref.transform;
  return {m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]};
}

TEST(TextureTransform, CornersLandWhereTheExtensionsExampleSaysTheyDo) {
  // "This example utilizes only the lower left quadrant of the source image, rotated clockwise 90 degrees."
  GltfBuilder builder = with_material(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"texCoord", 0},
           {"extensions",
            {{"KHR_texture_transform",
              {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}, {"texCoord", 1}}}}}}}}}},
      {{{"uri", data_uri(pixel(1, 2, 3))}}});
  const Scene scene = load(builder);
  const TextureRef& ref = scene.materials.at(0).base_color_texture;
  EXPECT_EQ(ref.uv_set, 1);
  EXPECT_TRUE(ref.has_transform);
  const auto expect = [&](Vec2f at, Vec2f wanted) {
    const Vec2f got = transformed(ref, at.x, at.y);
    EXPECT_NEAR(got.x, wanted.x, 1e-6);
    EXPECT_NEAR(got.y, wanted.y, 1e-6);
  };
  expect({0, 0}, {0, 1});
  expect({1, 0}, {0, 0.5});
  expect({0, 1}, {0.5, 1});
  expect({1, 1}, {0.5, 0.5});
}

TEST(TextureTransform, ScaleComesBeforeRotation) {
  GltfBuilder builder = with_material(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", kPi / 2}, {"scale", {2, 3}}}}}}}}}}},
      {{{"uri", data_uri(pixel(1, 2, 3))}}});
  const Scene scene = load(builder);
  const TextureRef& ref = scene.materials.at(0).base_color_texture;
  EXPECT_NEAR(transformed(ref, 0, 1).x, 3, 1e-6);
  EXPECT_NEAR(transformed(ref, 1, 0).y, -2, 1e-6);
}

TEST(Textures, WrapModesAndNearestArrive) {
  GltfBuilder builder = with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
       {"normalTexture", {{"index", 2}, {"scale", 0.5}}}},
      {{{"uri", data_uri(pixel(1, 2, 3))}}, {{"uri", data_uri(pixel(4, 5, 6))}}, {{"uri", data_uri(pixel(7, 8, 9))}}},
      {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}},
       {{"wrapS", 33648}, {"wrapT", 10497}, {"magFilter", 9729}},
       json::object()});
  const Scene scene = load(builder);
  const Material& material = scene.materials.at(0);
  const Texture& base = scene.textures.at(static_cast<std::size_t>(material.base_color_texture.texture));
  EXPECT_EQ(base.wrap_u, TextureWrap::clamp);
  EXPECT_EQ(base.wrap_v, TextureWrap::mirror);
  EXPECT_TRUE(base.nearest);
  EXPECT_TRUE(base.srgb);
  EXPECT_EQ(base.levels.at(0).rgba, (std::vector<std::uint8_t>{1, 2, 3, 255}));
  const Texture& rough = scene.textures.at(static_cast<std::size_t>(material.metallic_roughness_texture.texture));
  EXPECT_EQ(rough.wrap_u, TextureWrap::mirror);
  EXPECT_EQ(rough.wrap_v, TextureWrap::repeat);
  EXPECT_FALSE(rough.nearest);
  EXPECT_FALSE(rough.srgb);
  const Texture& normal = scene.textures.at(static_cast<std::size_t>(material.normal_texture.texture));
  EXPECT_EQ(normal.wrap_u, TextureWrap::repeat);
  EXPECT_FALSE(normal.srgb);
  EXPECT_EQ(material.normal_scale, 0.5F);
}

TEST(Textures, OnePictureForTwoUsesIsTwoTexturesAndForTheSameUseOne) {
  GltfBuilder builder = with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}}},
      {{{"uri", data_uri(pixel(10, 20, 30))}}});
  builder.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
  builder.json["textures"].push_back({{"source", 0}});
  const Scene scene = load(builder);
  EXPECT_EQ(scene.textures.size(), 2U);
  EXPECT_EQ(scene.materials.at(0).base_color_texture.texture, scene.materials.at(1).base_color_texture.texture);
  EXPECT_NE(scene.materials.at(0).base_color_texture.texture, scene.materials.at(0).metallic_roughness_texture.texture);
}

TEST(Textures, FilesAreFoundByPercentEncodedAndParentUris) {
  const test::TempFolder folder;
  folder.write("pictures/a b#1.png", pixel(11, 22, 33));
  GltfBuilder builder = with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
       {"emissiveFactor", {1, 1, 1}},
       {"emissiveTexture", {{"index", 1}}}},
      {{{"uri", "../pictures/a%20b%231.png"}}, {{"uri", "../x/../pictures/a b#1.png"}}});
  SceneReadOptions anywhere;
  anywhere.allow_outside = true;
  const Scene scene = load_scene(folder.write("deep/scene.gltf", builder.text()), anywhere);
  EXPECT_EQ(scene.textures.size(), 2U);  // colour (base and emission share it) and data
  EXPECT_EQ(scene.textures.at(0).levels.at(0).rgba, (std::vector<std::uint8_t>{11, 22, 33, 255}));
}

TEST(Textures, BufferViewImagesInGlb) {
  GltfBuilder builder = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder.json["images"] = {{{"bufferView", builder.add_view(pixel(7, 8, 9))}, {"mimeType", "image/png"}}};
  builder.json["textures"] = {{{"source", 0}}};
  const test::TempFolder folder;
  const Scene scene = load_scene(folder.write("scene.glb", builder.glb()));
  EXPECT_EQ(scene.textures.at(0).levels.at(0).rgba, (std::vector<std::uint8_t>{7, 8, 9, 255}));
  EXPECT_EQ(summarize(scene).triangles_instanced, 1U);
}

TEST(Textures, EmptyImagesAreToldAndLeftOut) {
  GltfBuilder builder =
      with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}, json::array({json::object()}));
  const Scene scene = load(builder);
  EXPECT_FALSE(scene.materials.at(0).base_color_texture.present());
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("textures[0]"));
}

TEST(Textures, SixteenBitPicturesKeepTheirDepth) {
  GltfBuilder builder =
      with_material({{"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", 0}}}}}},
                    {{{"uri", data_uri(test::png_bytes(1, 1, PngColor::rgb, 16, {0, 32897, 65534}))}}});
  const Scene scene = load(builder);
  EXPECT_EQ(scene.textures.at(0).format, TexelFormat::unorm16);
  const std::vector<std::uint8_t>& texel = scene.textures.at(0).levels.at(0).rgba;
  std::array<std::uint16_t, 4> codes{};
  ASSERT_EQ(texel.size(), sizeof codes);
  std::memcpy(codes.data(), texel.data(), sizeof codes);
  EXPECT_EQ(codes, (std::array<std::uint16_t, 4>{0, 32897, 65534, 65535}));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Extensions, UsedButUnknownIsOneWarningEach) {
  GltfBuilder builder = with_material({{"extensions", {{"KHR_materials_unheard_of", json::object()}}}});
  builder.json["extensionsUsed"] = {"KHR_materials_unheard_of", "KHR_texture_transform", "VENDOR_thing"};
  const Scene scene = load(builder);
  ASSERT_EQ(scene.warnings.size(), 2U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("KHR_materials_unheard_of"));
  EXPECT_THAT(scene.warnings[1], HasSubstr("VENDOR_thing"));
  EXPECT_EQ(scene.ignored.size(), 2U);
  EXPECT_EQ(scene.extensions_used.size(), 3U);
}

}  // namespace
}  // namespace gazetrace::gltf_material_test
