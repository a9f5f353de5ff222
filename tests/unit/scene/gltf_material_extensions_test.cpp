// SPDX-License-Identifier: Apache-2.0
// Every field of every material extension arrives, with its default where it is missing, and says where it is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::gltf_material_extensions_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using ::testing::HasSubstr;

// A triangle whose material has one extension, and one texture of a single pixel.
GltfBuilder with_extension(const std::string& name, const json& fields, json material = json::object()) {
  GltfBuilder builder;
  material["extensions"][name] = fields;
  builder.json["materials"] = {material};
  builder.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(test::png_bytes(1, 1, test::PngColor::rgba,
                                                                                             8, {10, 20, 30, 40}))}}};
  builder.json["textures"] = {{{"source", 0}}};
  builder.json["extensionsUsed"] = {name};
  builder.json["extensionsRequired"] = {name};
  json primitive{{"material", 0}};
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_1"}) {
    primitive["attributes"][set] = builder.add<float>({0, 0, 1, 0, 0, 1}, 2);
  }
  builder.add_triangle(primitive);
  return builder;
}

Scene load(GltfBuilder builder) {
  const test::TempFolder folder;
  return load_scene(folder.write("scene.gltf", builder.text()));
}
Material read(const std::string& name, const json& fields, const json& material = json::object()) {
  const Scene scene = load(with_extension(name, fields, material));
  EXPECT_TRUE(scene.ignored.empty());
  EXPECT_TRUE(scene.warnings.empty());
  return scene.materials.at(0);
}

const json plain_texture{{"index", 0}};
// On the second set of coordinates, moved by (0.25, 0.5).
const json moved_texture{{"index", 0},
                         {"texCoord", 1},
                         {"scale", 0.5},
                         {"extensions", {{"KHR_texture_transform", {{"offset", {0.25, 0.5}}}}}}};

void expect_moved(const TextureRef& ref) {
  EXPECT_TRUE(ref.present());
  EXPECT_EQ(ref.uv_set, 1);
  EXPECT_TRUE(ref.has_transform);
  EXPECT_EQ(ref.transform[2], 0.25F);
  EXPECT_EQ(ref.transform[5], 0.5F);
}

TEST(MaterialExtensions, EveryOneOfTheListMayBeRequiredAndChangesNothingWhenEmpty) {
  const std::vector<MaterialExtensionInfo> all = material_extensions();
  EXPECT_EQ(all.size(), 12U);
  for (const MaterialExtensionInfo& info : all) {
    EXPECT_FALSE(info.description.empty());
    const Material material = read(info.name, json::object());
    if (info.name != "KHR_materials_pbrSpecularGlossiness") {
      EXPECT_FALSE(layers_of(material).any()) << info.name;
      EXPECT_FALSE(features_of(load(with_extension(info.name, json::object()))).layers.any()) << info.name;
    }
  }
}

// Numbers that JSON can hold and floats cannot.
TEST(MaterialExtensions, HugeNumbersAreClampedWithAWarning) {
  const auto check = [](const std::string& name, const json& fields, const auto& value_of, float most) {
    const Scene scene = load(with_extension(name, fields, {{"emissiveFactor", {1, 0, 0}}}));
    EXPECT_EQ(value_of(scene.materials.at(0)), most) << name;
    // A clamped strength is told as an emission that is not what was given, too.
    ASSERT_FALSE(scene.warnings.empty()) << name;
    EXPECT_NE(scene.warnings[0].find("is outside its range and was clamped"), std::string::npos) << scene.warnings[0];
  };
  check(
      "KHR_materials_dispersion", {{"dispersion", 1e300}}, [](const Material& m) { return m.dispersion; }, 1000);
  check(
      "KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceThicknessMaximum", 1e300}},
      [](const Material& m) { return m.iridescence.thickness_max_nm; }, 1e6F);
  check(
      "KHR_materials_emissive_strength", {{"emissiveStrength", 1e300}}, [](const Material& m) { return m.emission.x; },
      1e30F);
  const Scene shining = load(with_extension("KHR_materials_emissive_strength", {{"emissiveStrength", 1e300}},
                                            {{"emissiveFactor", {1, 0, 0}}}));
  EXPECT_EQ(shining.materials.at(0).emission.y, 0);
}

TEST(MaterialExtensions, IorAndSpecular) {
  EXPECT_EQ(read("KHR_materials_ior", {{"ior", 1.33}}).ior, 1.33F);
  EXPECT_EQ(read("KHR_materials_ior", {{"ior", 0}}).ior, 0);
  Material material = read("KHR_materials_specular", {{"specularFactor", 0.25},
                                                      {"specularColorFactor", {0.5, 1, 2}},
                                                      {"specularTexture", plain_texture},
                                                      {"specularColorTexture", moved_texture}});
  EXPECT_EQ(material.specular.factor, 0.25F);
  EXPECT_EQ(material.specular.color, (Vec3f{0.5F, 1, 2}));
  EXPECT_TRUE(material.specular.texture.present());
  expect_moved(material.specular.color_texture);
  // A metal has no dielectric part that could show it.
  Material metal = material;
  material.metallic = 0;
  metal.metallic = 1;
  EXPECT_TRUE(layers_of(material).specular);
  EXPECT_FALSE(layers_of(metal).specular);
}

TEST(MaterialExtensions, Clearcoat) {
  const Material material = read("KHR_materials_clearcoat", {{"clearcoatFactor", 0.5},
                                                             {"clearcoatRoughnessFactor", 0.25},
                                                             {"clearcoatTexture", plain_texture},
                                                             {"clearcoatRoughnessTexture", plain_texture},
                                                             {"clearcoatNormalTexture", moved_texture}});
  EXPECT_EQ(material.clearcoat.factor, 0.5F);
  EXPECT_EQ(material.clearcoat.roughness, 0.25F);
  EXPECT_EQ(material.clearcoat.normal_scale, 0.5F);
  EXPECT_TRUE(material.clearcoat.texture.present());
  EXPECT_TRUE(material.clearcoat.roughness_texture.present());
  expect_moved(material.clearcoat.normal_texture);
  EXPECT_TRUE(layers_of(material).clearcoat);
}

TEST(MaterialExtensions, TexturesOfALayerThatCannotShowAreNotRead) {
  const Scene scene = load(with_extension("KHR_materials_clearcoat", {{"clearcoatTexture", plain_texture}}));
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_FALSE(features_of(scene).textures);
}

TEST(MaterialExtensions, TransmissionVolumeAndDispersion) {
  const Material thin =
      read("KHR_materials_transmission", {{"transmissionFactor", 0.75}, {"transmissionTexture", plain_texture}},
           {{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  EXPECT_EQ(thin.transmission.factor, 0.75F);
  EXPECT_TRUE(thin.transmission.texture.present());
  EXPECT_TRUE(layers_of(thin).transmission);
  EXPECT_FALSE(layers_of(thin).volume);

  Material body = read("KHR_materials_volume",
                       {{"thicknessFactor", 0.5}, {"attenuationColor", {0.1, 0.2, 0.3}}, {"attenuationDistance", 4}});
  EXPECT_EQ(body.volume.thickness, 0.5F);
  EXPECT_EQ(body.volume.attenuation_color, (Vec3f{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(body.volume.attenuation_distance_m, 4);
  EXPECT_FALSE(layers_of(body).any());  // nothing lets light in
  body.metallic = 0;
  body.transmission.factor = 1;
  EXPECT_TRUE(layers_of(body).volume);
  EXPECT_TRUE(std::isinf(read("KHR_materials_volume", json::object()).volume.attenuation_distance_m));

  EXPECT_EQ(read("KHR_materials_dispersion", {{"dispersion", 0.5}}).dispersion, 0.5F);
}

TEST(MaterialExtensions, SheenAnisotropyIridescence) {
  const Material cloth = read("KHR_materials_sheen", {{"sheenColorFactor", {0.25, 0.5, 1}},
                                                      {"sheenRoughnessFactor", 0.5},
                                                      {"sheenColorTexture", plain_texture},
                                                      {"sheenRoughnessTexture", moved_texture}});
  EXPECT_EQ(cloth.sheen.color, (Vec3f{0.25F, 0.5F, 1}));
  EXPECT_EQ(cloth.sheen.roughness, 0.5F);
  EXPECT_TRUE(cloth.sheen.color_texture.present());
  expect_moved(cloth.sheen.roughness_texture);

  const Material brushed =
      read("KHR_materials_anisotropy",
           {{"anisotropyStrength", 0.5}, {"anisotropyRotation", -1.5}, {"anisotropyTexture", moved_texture}});
  EXPECT_EQ(brushed.anisotropy.strength, 0.5F);
  EXPECT_EQ(brushed.anisotropy.rotation_rad, -1.5F);
  expect_moved(brushed.anisotropy.texture);

  const Material film = read("KHR_materials_iridescence", {{"iridescenceFactor", 1},
                                                           {"iridescenceIor", 1.5},
                                                           {"iridescenceThicknessMinimum", 50},
                                                           {"iridescenceThicknessMaximum", 500},
                                                           {"iridescenceTexture", plain_texture},
                                                           {"iridescenceThicknessTexture", moved_texture}});
  EXPECT_EQ(film.iridescence.factor, 1);
  EXPECT_EQ(film.iridescence.ior, 1.5F);
  EXPECT_EQ(film.iridescence.thickness_min_nm, 50);
  EXPECT_EQ(film.iridescence.thickness_max_nm, 500);
  EXPECT_TRUE(film.iridescence.texture.present());
  expect_moved(film.iridescence.thickness_texture);
}

TEST(MaterialExtensions, DiffuseTransmission) {
  const Material leaf =
      read("KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0.5},
                                                  {"diffuseTransmissionColorFactor", {0.25, 1, 0.5}},
                                                  {"diffuseTransmissionTexture", plain_texture},
                                                  {"diffuseTransmissionColorTexture", moved_texture}});
  EXPECT_EQ(leaf.diffuse_transmission.factor, 0.5F);
  EXPECT_EQ(leaf.diffuse_transmission.color, (Vec3f{0.25F, 1, 0.5F}));
  EXPECT_TRUE(leaf.diffuse_transmission.texture.present());
  expect_moved(leaf.diffuse_transmission.color_texture);
}

TEST(MaterialExtensions, SpecularGlossinessBecomesADielectricWithColoredReflection) {
  const Material material = read("KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                                                         {"specularFactor", {0.5, 0.25, 1}},
                                                                         {"glossinessFactor", 0.75},
                                                                         {"diffuseTexture", plain_texture},
                                                                         {"specularGlossinessTexture", moved_texture}});
  EXPECT_EQ(material.base_color, (Vec4f{0.1F, 0.2F, 0.3F, 0.4F}));
  EXPECT_EQ(material.metallic, 0);
  EXPECT_EQ(material.roughness, 0.25F);
  EXPECT_EQ(material.ior, 0);
  EXPECT_EQ(material.specular.color, (Vec3f{0.5F, 0.25F, 1}));
  EXPECT_TRUE(material.base_color_texture.present());
  EXPECT_TRUE(material.specular.color_texture_has_glossiness);
  expect_moved(material.specular.color_texture);
  EXPECT_TRUE(layers_of(material).ior);
}

TEST(MaterialExtensions, WrongKindsNameTheirPlace) {
  struct Case {
    const char* extension;
    json fields;
    const char *place, *problem;
  };
  for (const Case& c :
       {Case{"KHR_materials_clearcoat", {{"clearcoatFactor", "much"}}, "clearcoatFactor", "not a number"},
        Case{"KHR_materials_sheen", {{"sheenColorFactor", {1, 2}}}, "sheenColorFactor", "3 numbers"},
        Case{"KHR_materials_sheen", {{"sheenColorFactor", {1, 2, "x"}}}, "sheenColorFactor", "3 numbers"},
        Case{"KHR_materials_clearcoat",
             {{"clearcoatFactor", 1}, {"clearcoatTexture", 3}},
             "clearcoatTexture",
             "not a texture"},
        Case{"KHR_materials_clearcoat",
             {{"clearcoatTexture", {{"index", 7}}}},
             "clearcoatTexture.index",
             "1 textures"}}) {
    try {
      load(with_extension(c.extension, c.fields));
      ADD_FAILURE() << c.place;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr("materials[0].extensions." + std::string(c.extension) + "." + c.place));
      EXPECT_THAT(error.what(), HasSubstr(c.problem));
    }
  }
}

TEST(MaterialExtensions, NumbersOutsideTheirRangeAreClampedAndTold) {
  const Scene scene = load(with_extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1.5}}));
  EXPECT_EQ(scene.materials.at(0).clearcoat.factor, 1);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("KHR_materials_clearcoat.clearcoatFactor 1.5"));
}

}  // namespace
}  // namespace gazetrace::gltf_material_extensions_test
