// SPDX-License-Identifier: Apache-2.0
// Punctual lights and smooth glass: told at loading, where both are there, and nowhere else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::smooth_glass_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A triangle of transmitting material under a sun. Texture 0 is one pixel whose green is 20 / 255.
struct GlassScene {
  json pbr{{"metallicFactor", 0}, {"roughnessFactor", 0}};
  double transmission = 1;
  bool sun = true, used = true;

  [[nodiscard]] Warnings warnings() const {
    test::GltfBuilder builder;
    json primitive{{"material", used ? 1 : 0}};
    primitive["attributes"]["TEXCOORD_0"] = builder.add<float>({0, 0, 1, 0, 0, 1}, 2);
    builder.add_triangle(primitive);
    json glass{{"name", "pane"}, {"pbrMetallicRoughness", pbr}};
    glass["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = transmission;
    builder.json["materials"] = {{{"name", "wall"}}, glass};
    builder.json["images"] = {
        {{"uri", "data:image/png;base64," +
                     test::base64(test::png_bytes(1, 1, test::PngColor::rgba, 8, {255, 20, 255, 255}))}}};
    builder.json["textures"] = {{{"source", 0}}};
    if (sun) {
      builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}}};
      builder.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    }
    const test::TempFolder folder;
    return load_scene(folder.write("scene.gltf", builder.text())).warnings;
  }
};

const auto kTold = ElementsAre(HasSubstr("through smooth glass (materials[1] 'pane')"));

TEST(SmoothGlass, IsToldUnderPunctualLights) {
  EXPECT_THAT(GlassScene{}.warnings(), kTold);
  EXPECT_THAT(GlassScene{.transmission = 0.1}.warnings(), kTold);
  EXPECT_THAT((GlassScene{.pbr = {{"metallicFactor", 0}, {"roughnessFactor", 0.19}}}.warnings()), kTold);
}

TEST(SmoothGlass, IsToldWhereATextureMakesItSmooth) {
  json pbr{{"metallicFactor", 0}, {"roughnessFactor", 1}};
  EXPECT_THAT(GlassScene{.pbr = pbr}.warnings(), IsEmpty());
  pbr["metallicRoughnessTexture"] = {{"index", 0}};
  EXPECT_THAT(GlassScene{.pbr = pbr}.warnings(), kTold);
}

TEST(SmoothGlass, IsNotToldOtherwise) {
  EXPECT_THAT(GlassScene{.sun = false}.warnings(), IsEmpty());
  EXPECT_THAT(GlassScene{.used = false}.warnings(), IsEmpty());
  EXPECT_THAT(GlassScene{.transmission = 0}.warnings(), IsEmpty());
  EXPECT_THAT((GlassScene{.pbr = {{"metallicFactor", 1}, {"roughnessFactor", 0}}}.warnings()), IsEmpty());
  EXPECT_THAT((GlassScene{.pbr = {{"metallicFactor", 0}, {"roughnessFactor", 0.3}}}.warnings()), IsEmpty());
}

}  // namespace
}  // namespace gazetrace::smooth_glass_test
