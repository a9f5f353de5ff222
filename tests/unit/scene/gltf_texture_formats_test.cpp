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

namespace gazetrace::gltf_texture_formats_test {
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

// Written by Pillow 13.0: 2 x 1 pixels, 200 100 50 with alpha 128 and 10 220 90 with alpha 0, without loss and with.
TEST(WebpTexture, KeepsItsColorStraight) {
  const Bytes lossless{82, 73, 70, 70, 34, 0,   0,  0,   87, 69,  66, 80, 86,  80, 56, 76, 21, 0,   0,   0, 47,
                       1,  0,  0,  16, 15, 112, 68, 238, 43, 248, 94, 11, 123, 0,  35, 28, 25, 209, 255, 0, 0};
  const ImageRgba exact = read_image_rgba(lossless, "lossless");
  EXPECT_TRUE(exact.has_alpha);
  EXPECT_EQ(exact.bytes, (Bytes{200, 100, 50, 128, 10, 220, 90, 0}));
  const Bytes lossy{82,  73,  70,  70,  98,  0,   0,   0,   87,  69,  66,  80,  86,  80,  56,  88,  10,  0,
                    0,   0,   16,  0,   0,   0,   1,   0,   0,   0,   0,   0,   65,  76,  80,  72,  3,   0,
                    0,   0,   0,   128, 0,   0,   86,  80,  56,  32,  56,  0,   0,   0,   48,  2,   0,   157,
                    1,   42,  2,   0,   1,   0,   0,   192, 18,  37,  160, 2,   116, 186, 1,   248, 0,   3,
                    33,  6,   251, 128, 0,   254, 7,   254, 59,  66,  127, 247, 121, 191, 105, 235, 218, 122,
                    254, 166, 127, 252, 101, 79,  144, 31,  241, 149, 63,  226, 230, 0,   0,   0};
  const ImageRgba near = read_image_rgba(lossy, "lossy");
  const Bytes by_pillow{201, 100, 50, 128, 218, 116, 66, 0};
  ASSERT_EQ(near.bytes.size(), by_pillow.size());
  for (std::size_t i = 0; i < by_pillow.size(); ++i) {
    EXPECT_NEAR(near.bytes[i], by_pillow[i], 1) << i;
  }
  const Bytes animated{82,  73, 70, 70, 138, 0,   0,   0,   87,  69, 66, 80, 86, 80,  56,  88, 10, 0,   0,  0,  18,
                       0,   0,  0,  1,  0,   0,   0,   0,   0,   65, 78, 73, 77, 6,   0,   0,  0,  0,   0,  0,  0,
                       0,   0,  65, 78, 77,  70,  42,  0,   0,   0,  0,  0,  0,  0,   0,   0,  1,  0,   0,  0,  0,
                       0,   0,  0,  0,  2,   86,  80,  56,  76,  18, 0,  0,  0,  47,  1,   0,  0,  16,  15, 48, 100,
                       131, 60, 50, 3,  24,  240, 200, 136, 254, 7,  65, 78, 77, 70,  44,  0,  0,  0,   0,  0,  0,
                       0,   0,  0,  1,  0,   0,   0,   0,   0,   0,  0,  0,  2,  86,  80,  56, 76, 19,  0,  0,  0,
                       47,  1,  0,  0,  16,  15,  48,  100, 131, 60, 50, 3,  24, 240, 168, 64, 68, 255, 3,  0};
  EXPECT_THROW(static_cast<void>(read_image_rgba(animated, "animated")), Error);
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
}  // namespace gazetrace::gltf_texture_formats_test
