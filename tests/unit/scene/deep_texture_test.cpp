// SPDX-License-Identifier: Apache-2.0
// Pictures of more than 8 bits a channel, and pictures of extreme sizes: what is kept of them and what a read returns,
// against the same worked out in double.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/half.hpp"
#include "core/hash.hpp"
#include "core/image_io.hpp"
#include "gazetrace/error.hpp"
#include "scene/texture.hpp"
#include "support/png_bytes.hpp"
#include "trace/lights/emission_average.hpp"
#include "trace/scene/texture.hpp"

namespace gazetrace::deep_texture_test {
namespace {

using test::PngColor;
using Bytes = std::vector<std::uint8_t>;

// IEEE 754 section 3.4 with a 5-bit exponent and 10 bits of fraction.
double value_of_half(std::uint16_t code) {
  const int exponent = code >> 10U & 31U;
  const int fraction = code & 1023U;
  const double magnitude = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return (code & 0x8000U) != 0 ? -magnitude : magnitude;
}

TEST(Half, EveryFiniteCodeSurvives) {
  for (std::uint32_t code = 0; code < 65536; ++code) {
    if ((code & 0x7c00U) == 0x7c00U) {
      continue;
    }
    const auto half = static_cast<std::uint16_t>(code);
    EXPECT_EQ(static_cast<double>(half_to_float(half)), value_of_half(half)) << code;
    EXPECT_EQ(float_to_half(half_to_float(half)), half) << code;
  }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const float value = std::bit_cast<float>((hash32(i) & 0x07ffffffU) + (102U << 23U));  // 2^-25 to 2^-9 and beyond
    const std::uint16_t half = float_to_half(value);
    const double off = std::fabs(value_of_half(half) - static_cast<double>(value));
    if (half > 0) {
      EXPECT_LE(off, std::fabs(value_of_half(static_cast<std::uint16_t>(half - 1)) - static_cast<double>(value)));
    }
    EXPECT_LE(off, std::fabs(value_of_half(static_cast<std::uint16_t>(half + 1)) - static_cast<double>(value)));
  }
  for (std::uint16_t code = 0; code < 0x7bff; ++code) {
    const auto tie =
        static_cast<float>((value_of_half(code) + value_of_half(static_cast<std::uint16_t>(code + 1))) / 2);
    EXPECT_EQ(float_to_half(tie), code + code % 2) << code;
    EXPECT_EQ(float_to_half(-tie), 0x8000 + code + code % 2) << code;
  }
  EXPECT_EQ(float_to_half(1e30F), 0x7bff) << "65504, not infinite";
  EXPECT_EQ(float_to_half(65520.0F), 0x7bff);
}

double linear(double c) {  // IEC 61966-2-1
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

Texture from_png(PngColor color, int width, int height, const std::vector<std::uint16_t>& samples, TextureUse use,
                 int bits = 16) {
  return make_texture(read_image_rgba(test::png_bytes(width, height, color, bits, samples), "test"), use);
}

TEST(DeepTexture, ColorsKeepElevenBitsOfLinearLight) {
  std::vector<std::uint16_t> samples;
  for (std::uint32_t i = 0; i < 64 * 3; ++i) {
    samples.push_back(static_cast<std::uint16_t>(hash32(i) & 0xffffU));
  }
  const Texture texture = from_png(PngColor::rgb, 64, 1, samples, TextureUse::color);
  EXPECT_EQ(texture.format, TexelFormat::half);
  EXPECT_FALSE(texture.srgb);
  for (std::size_t x = 0; x < 64; ++x) {
    const Vec4f c = read_texture(texture, (static_cast<float>(x) + 0.5F) / 64, 0.5F, 0);
    const std::array<float, 3> got{c.x, c.y, c.z};
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = linear(samples[3 * x + k] / 65535.0);
      EXPECT_NEAR(got[k], expected, expected * 0x1p-11 + 1e-7);
    }
    EXPECT_EQ(c.w, 1);
  }
}

TEST(DeepTexture, DarkNeighboursOfOneEightBitCodeStayApart) {
  const Texture texture = from_png(PngColor::gray, 2, 1, {600, 640}, TextureUse::color);
  EXPECT_LT(read_texture(texture, 0.25F, 0, 0).x, read_texture(texture, 0.75F, 0, 0).x);
}

TEST(DeepTexture, NormalsKeepAllSixteenBits) {
  const std::vector<std::uint16_t> samples{32768, 40000, 60001, 32767, 1, 65535};
  const Texture texture = from_png(PngColor::rgb, 2, 1, samples, TextureUse::normal);
  EXPECT_EQ(texture.format, TexelFormat::unorm16);
  for (std::size_t x = 0; x < 2; ++x) {
    const Vec4f c = read_texture(texture, x == 0 ? 0.25F : 0.75F, 0, 0);
    EXPECT_NEAR(c.x, samples[3 * x] / 65535.0, 1e-7);
    EXPECT_NEAR(c.y, samples[3 * x + 1] / 65535.0, 1e-7);
    EXPECT_NEAR(c.z, samples[3 * x + 2] / 65535.0, 1e-7);
  }
  // (+-sin 45, 0, cos 45) average to +z of unit length.
  const Texture two = from_png(PngColor::rgb, 2, 1, {55938, 32768, 55938, 9597, 32768, 55938}, TextureUse::normal);
  const Vec4f mean = read_texture(two, 0.5F, 0.5F, 1);
  EXPECT_NEAR(mean.x, 0.5, 3e-5);
  EXPECT_NEAR(mean.z, 1, 3e-5);
}

TEST(DeepTexture, LevelsAverageLightWeightedByAlpha) {
  const Texture texture =
      from_png(PngColor::rgba, 2, 1, {65535, 65535, 0, 65535, 0, 0, 65535, 16384}, TextureUse::color);
  EXPECT_TRUE(texture.has_alpha);
  const Vec4f mean = read_texture(texture, 0.5F, 0.5F, 1);
  const double a = 16384 / 65535.0;
  EXPECT_NEAR(mean.x, 1 / (1 + a), 1e-3);
  EXPECT_NEAR(mean.z, a / (1 + a), 1e-3);
  EXPECT_NEAR(mean.w, (1 + a) / 2, 1e-3);
}

// Radiance's format by hand: mantissas and a shared exponent; rows shorter than 8 pixels are never packed.
Bytes hdr_file(const std::vector<std::array<std::uint8_t, 4>>& pixels) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X " + std::to_string(pixels.size()) + "\n";
  Bytes file(header.begin(), header.end());
  for (const auto& pixel : pixels) {
    file.insert(file.end(), pixel.begin(), pixel.end());
  }
  return file;
}

TEST(DeepTexture, FloatsAreLinearAndMayExceedOne) {
  // 2^(132 - 136) = 1/16 a step: 12.5, 6.25 and 1; and 2^-8 a step: 0.5, 0.25, 0.
  const Bytes file = hdr_file({{200, 100, 16, 132}, {128, 64, 0, 128}});
  const ImageRgba image = read_image_rgba(file, "test");
  EXPECT_TRUE(image.is_linear);
  const Texture texture = make_texture(ImageRgba(image), TextureUse::color);
  EXPECT_EQ(texture.format, TexelFormat::half);
  const Vec4f bright = read_texture(texture, 0.25F, 0, 0);
  EXPECT_NEAR(bright.x, 12.5, 0.05);  // some readers add half a step
  EXPECT_NEAR(bright.y, 6.25, 0.05);
  const Vec4f mean = read_texture(texture, 0.5F, 0.5F, 1);
  EXPECT_NEAR(mean.x, 6.5, 0.05);

  Scene scene;
  scene.textures.push_back(texture);
  Material material;
  material.emission = {2, 2, 2};
  material.emissive_texture.texture = 0;
  Geometry geometry;
  geometry.uv0 = {{0.1F, 0}, {0.2F, 0}, {0.15F, 1}};
  geometry.triangles = {{0, 1, 2}};
  // The coordinates touch both texels.
  EXPECT_NEAR(average_emission(scene, material, geometry, 0).x, 2 * (12.5 + 0.5) / 2, 0.1);

  // As a base colour nothing reflects more than all light.
  scene.materials.emplace_back().base_color_texture.texture = 0;
  const std::vector<ShadingMaterial> shading = make_materials(scene);
  ASSERT_EQ(shading.at(0).group_count, 1);
  TexelValues values;
  read_group(shading[0].groups[0], 0.25F, 0, 0, values);
  EXPECT_EQ(values.base, (Vec3f{1, 1, 1}));
  read_group(shading[0].groups[0], 0.75F, 0, 0, values);
  EXPECT_NEAR(values.base.x, 0.5, 0.003);
}

TEST(DeepTexture, ReadsBesideEightBitOnesOfTheSameSize) {
  Scene scene;
  scene.textures.push_back(from_png(PngColor::rgb, 2, 1, {255, 0, 0, 0, 255, 0}, TextureUse::color, 8));
  scene.textures.push_back(from_png(PngColor::rgb, 2, 1, {0, 32768, 16384, 0, 49152, 65535}, TextureUse::data));
  scene.textures.push_back(from_png(PngColor::rgb, 2, 1, {128, 128, 255, 128, 128, 255}, TextureUse::normal, 8));
  Material& material = scene.materials.emplace_back();
  material.base_color_texture.texture = 0;
  material.metallic_roughness_texture.texture = 1;
  material.normal_texture.texture = 2;
  const std::vector<ShadingMaterial> shading = make_materials(scene);
  ASSERT_EQ(shading.at(0).group_count, 2) << "the 8-bit ones share a read";
  TexelValues values;
  for (std::size_t g = 0; g < 2; ++g) {
    read_group(shading[0].groups[g], 0.25F, 0.5F, 0, values);
  }
  EXPECT_EQ(values.base, (Vec3f{1, 0, 0}));
  EXPECT_NEAR(values.roughness, 32768 / 65535.0, 1e-6);
  EXPECT_NEAR(values.metallic, 16384 / 65535.0, 1e-6);
  EXPECT_NEAR(values.normal.z, 1, 1e-6);
}

TEST(ExtremeTexture, OneTexelIsThatColorEverywhere) {
  for (const int bits : {8, 16}) {
    const auto code = static_cast<std::uint16_t>(bits == 8 ? 51 : 13107);  // 0.2
    const Texture texture = from_png(PngColor::gray, 1, 1, {code}, TextureUse::data, bits);
    ASSERT_EQ(texture.levels.size(), 1U);
    for (const float at : {0.0F, 0.5F, 1.0F, -7.3F, 1e8F, std::numeric_limits<float>::infinity()}) {
      for (const float level : {-50.0F, 0.0F, 3.0F, 100.0F}) {
        EXPECT_NEAR(read_texture(texture, at, at, level).x, 0.2, 1e-6) << bits << " " << at << " " << level;
      }
    }
  }
}

// 16384 wide, and as high as keeps the test quick.
TEST(ExtremeTexture, SixteenThousandTexelsAreFoundOneByOne) {
  constexpr int kWidth = 16384;
  constexpr int kHeight = 4;
  for (const int bits : {8, 16}) {
    const double largest = bits == 8 ? 255 : 65535;
    std::vector<std::uint16_t> samples;
    double sum = 0;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(kWidth * kHeight); ++i) {
      samples.push_back(static_cast<std::uint16_t>(hash32(i) & (bits == 8 ? 0xffU : 0xffffU)));
      sum += samples.back() / largest;
    }
    Texture texture = from_png(PngColor::gray, kWidth, kHeight, samples, TextureUse::data, bits);
    ASSERT_EQ(texture.levels.size(), 15U);
    EXPECT_NEAR(read_texture(texture, 0.5F, 0.5F, 14).x, sum / (kWidth * kHeight), 0.003);
    const auto value = [&](int x, int y) {
      const int column = (x % kWidth + kWidth) % kWidth;
      const int row = (y % kHeight + kHeight) % kHeight;
      return samples[static_cast<std::size_t>(row * kWidth + column)] / largest;
    };
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const float u = static_cast<float>(hash32(2 * i) >> 8U) * 0x1p-24F;
      const float v = static_cast<float>(hash32(2 * i + 1) >> 8U) * 0x1p-24F;
      const double x = static_cast<double>(u) * kWidth - 0.5;
      const double y = static_cast<double>(v) * kHeight - 0.5;
      const int x0 = static_cast<int>(std::floor(x));
      const int y0 = static_cast<int>(std::floor(y));
      const double fx = x - x0;
      const double fy = y - y0;
      const double expected = (value(x0, y0) * (1 - fx) + value(x0 + 1, y0) * fx) * (1 - fy) +
                              (value(x0, y0 + 1) * (1 - fx) + value(x0 + 1, y0 + 1) * fx) * fy;
      // A float coordinate has 10 bits left within a texel.
      EXPECT_NEAR(read_texture(texture, u, v, 0).x, expected, 0x1p-9) << u << " " << v;
    }
    texture.nearest = true;
    for (int x = 0; x < kWidth; ++x) {
      const double expected = value(x, 2);
      EXPECT_NEAR(read_texture(texture, (static_cast<float>(x) + 0.5F) / kWidth, 0.625F, 0).x, expected, 1e-6) << x;
    }
  }
}

}  // namespace
}  // namespace gazetrace::deep_texture_test
