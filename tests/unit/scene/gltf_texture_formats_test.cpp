// SPDX-License-Identifier: Apache-2.0
// Pictures in formats that extensions bring: read where they can be, else refused or replaced by what the file offers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image_io.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace {
namespace {

using nlohmann::json;
using test::error_of;
using test::GltfBuilder;
using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

void add_textured_triangle(GltfBuilder& builder) {
  builder.add_triangle({{"material", 0}, {"attributes", {{"TEXCOORD_0", builder.add<float>({0, 0, 1, 0, 0, 1}, 2)}}}});
  builder.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
}

Bytes flat_picture(const char* name, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  Bytes rgb;
  for (int i = 0; i < 8 * 8; ++i) {
    rgb.insert(rgb.end(), {r, g, b});
  }
  return encode_image(name, 8, 8, 8, rgb, {});
}

void expect_texel(const Scene& scene, const std::array<int, 3>& rgb, int tolerance) {
  ASSERT_EQ(scene.textures.size(), 1U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(scene.textures[0].levels[0].rgba[c], rgb[c], tolerance);
  }
}

TEST(WebpTexture, IsPreferredToItsFallback) {
  const test::TempFolder folder;
  folder.write("a.webp", flat_picture("a.webp", 200, 100, 50));
  for (const bool in_file : {false, true}) {
    GltfBuilder builder;
    add_textured_triangle(builder);
    json webp = {{"uri", "a.webp"}};
    if (in_file) {
      webp = {{"bufferView", builder.add_view(flat_picture("a.webp", 200, 100, 50))}, {"mimeType", "image/webp"}};
    }
    builder.json["images"] = {{{"uri", "fallback.png"}}, webp};
    builder.json["textures"] = {{{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
    builder.json["extensionsUsed"] = {"EXT_texture_webp"};
    builder.json["extensionsRequired"] = {"EXT_texture_webp"};
    const Scene scene = load_scene(folder.write("scene.gltf", builder.text()));
    EXPECT_TRUE(scene.warnings.empty());
    expect_texel(scene, {200, 100, 50}, 3);  // WebP keeps 4:2:0 YUV
  }
  GltfBuilder builder;
  add_textured_triangle(builder);
  builder.json["images"] = {{{"uri", "a.webp"}}};
  builder.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 3}}}}}}};
  EXPECT_THAT(error_of(folder.write("scene.gltf", builder.text())), HasSubstr("EXT_texture_webp.source: 3 is not"));
}

TEST(BasisTexture, IsRefusedWhereRequiredAndReplacedWhereNot) {
  const test::TempFolder folder;
  folder.write("a.png", flat_picture("a.png", 20, 40, 60));
  GltfBuilder builder;
  add_textured_triangle(builder);
  builder.json["images"] = {{{"uri", "a.png"}}, {{"uri", "a.ktx2"}}};
  builder.json["textures"] = {{{"source", 0}, {"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}}};
  builder.json["extensionsUsed"] = {"KHR_texture_basisu"};
  const Scene scene = load_scene(folder.write("scene.gltf", builder.text()));
  EXPECT_THAT(scene.warnings, ::testing::ElementsAre(HasSubstr("KHR_texture_basisu, which cannot be read")));
  expect_texel(scene, {20, 40, 60}, 0);
  builder.json["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_THAT(error_of(folder.write("scene.gltf", builder.json.dump())),
              HasSubstr("requires the extension KHR_texture_basisu, which is not supported; convert its textures"));
}

}  // namespace
}  // namespace gazetrace
