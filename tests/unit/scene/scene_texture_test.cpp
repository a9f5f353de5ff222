// SPDX-License-Identifier: Apache-2.0
// Decoding and mip levels against averages worked out here.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/image_io.hpp"
#include "scene/texture.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::scene_texture_test {
namespace {

using test::PngColor;
using Bytes = std::vector<std::uint8_t>;

Bytes decoded(PngColor color, int bits, const std::vector<std::uint16_t>& samples) {
  return read_image_rgba(test::png_bytes(1, 1, color, bits, samples), "test").bytes;
}

TEST(ReadImage, EveryLayoutBecomesRgba) {
  EXPECT_EQ(decoded(PngColor::gray, 8, {77}), (Bytes{77, 77, 77, 255}));
  EXPECT_EQ(decoded(PngColor::gray_alpha, 8, {77, 5}), (Bytes{77, 77, 77, 5}));
  EXPECT_EQ(decoded(PngColor::rgb, 8, {1, 2, 3}), (Bytes{1, 2, 3, 255}));
  EXPECT_EQ(decoded(PngColor::rgba, 8, {1, 2, 3, 4}), (Bytes{1, 2, 3, 4}));
}

TEST(ReadImage, ColorUnderZeroAlphaSurvives) {
  EXPECT_EQ(decoded(PngColor::rgba, 8, {200, 100, 50, 0}), (Bytes{200, 100, 50, 0}));
}

TEST(ReadImage, AlphaIsOnlyAlphaWhereSomethingShowsThrough) {
  const auto has_alpha = [](std::uint16_t a) {
    return read_image_rgba(test::png_bytes(2, 1, PngColor::rgba, 8, {1, 2, 3, 255, 1, 2, 3, a}), "test").has_alpha;
  };
  EXPECT_FALSE(has_alpha(255));
  EXPECT_TRUE(has_alpha(254));
}

TEST(ReadImage, RowsStartAtTheTop) {
  const auto image = read_image_rgba(test::png_bytes(1, 2, PngColor::gray, 8, {10, 20}), "test");
  EXPECT_EQ(image.bytes, (Bytes{10, 10, 10, 255, 20, 20, 20, 255}));
}

ImageRgba picture(int width, int height, const Bytes& rgba) {
  ImageRgba image{width, height, rgba, false, {}, false};
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    image.has_alpha = image.has_alpha || rgba[i] != 255;
  }
  return image;
}

TEST(MipLevels, HalveDownToOneTexel) {
  const Texture texture = make_texture(picture(13, 6, Bytes(13 * 6 * 4, 200)), TextureUse::data);
  std::vector<std::pair<int, int>> sizes;
  for (const auto& level : texture.levels) {
    sizes.emplace_back(level.width_px, level.height_px);
    EXPECT_EQ(level.rgba.size(), static_cast<std::size_t>(level.width_px * level.height_px * 4));
    EXPECT_EQ(level.rgba, Bytes(level.rgba.size(), 200));  // a constant stays one
  }
  EXPECT_EQ(sizes, (std::vector<std::pair<int, int>>{{13, 6}, {6, 3}, {3, 1}, {1, 1}}));
}

TEST(MipLevels, ColorIsAveragedInLinearLight) {
  const Texture texture = make_texture(picture(2, 1, {0, 255, 128, 255, 255, 255, 128, 255}), TextureUse::color);
  // Half of white is 188 in sRGB (IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055 = 0.73536).
  EXPECT_EQ(texture.levels.at(1).rgba, (Bytes{188, 255, 128, 255}));
  EXPECT_TRUE(texture.srgb);
  const Texture data = make_texture(picture(2, 1, {0, 255, 128, 255, 255, 255, 128, 255}), TextureUse::data);
  EXPECT_EQ(data.levels.at(1).rgba, (Bytes{128, 255, 128, 255}));
  EXPECT_FALSE(data.srgb);
}

TEST(MipLevels, HiddenTexelsDoNotBleed) {
  const Texture texture = make_texture(picture(2, 2,
                                               {200, 10, 30, 255, 0, 255, 0, 0,  //
                                                0, 255, 0, 0, 0, 255, 0, 0}),
                                       TextureUse::color);
  const Bytes& mean = texture.levels.at(1).rgba;
  EXPECT_EQ(mean, (Bytes{200, 10, 30, 64}));
  EXPECT_TRUE(texture.has_alpha);
}

TEST(MipLevels, AWhollyHiddenAreaKeepsItsColor) {
  const Texture texture = make_texture(picture(2, 1, {90, 60, 30, 0, 90, 60, 30, 0}), TextureUse::color);
  EXPECT_EQ(texture.levels.at(1).rgba, (Bytes{90, 60, 30, 0}));
}

TEST(MipLevels, NormalsAreAveragedToUnitLength) {
  // (+-sin 45, 0, cos 45) average to +z; stored plainly the blue channel would be 217.
  const Texture texture = make_texture(picture(2, 1, {218, 128, 218, 255, 37, 128, 218, 255}), TextureUse::normal);
  const Bytes& mean = texture.levels.at(1).rgba;
  EXPECT_NEAR(mean[0], 127.5, 1);
  EXPECT_NEAR(mean[1], 127.5, 1);
  EXPECT_EQ(mean[2], 255);
}

// An independent statement of the box filter for odd sizes: every texel of the picture has the same share in the 1 x 1
// level when each level covers the one above exactly.
TEST(MipLevels, OddSizesKeepTheMean) {
  for (const auto& [width, height] : {std::pair{5, 7}, std::pair{3, 1}, std::pair{33, 17}, std::pair{1, 9}}) {
    Bytes rgba;
    double sum = 0;
    for (int i = 0; i < width * height; ++i) {
      const auto value = static_cast<std::uint8_t>((i * 37) % 251);
      sum += value;
      rgba.insert(rgba.end(), {value, value, value, 255});
    }
    const Texture texture = make_texture(picture(width, height, rgba), TextureUse::data);
    EXPECT_NEAR(texture.levels.back().rgba[0], sum / (width * height), 0.51) << width << " x " << height;
  }
}

}  // namespace
}  // namespace gazetrace::scene_texture_test
