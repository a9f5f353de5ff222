// SPDX-License-Identifier: Apache-2.0
// The built-in views against arithmetic that is not OpenColorIO's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "color/ocio.hpp"
#include "gazetrace/color.hpp"

namespace gazetrace::color_view_test {
namespace {

struct Sample {
  Vec3f in;
  std::array<double, 3> out;
};

ColorSettings view(const char* name) {
  ColorSettings settings;
  settings.view = name;
  return settings;
}

std::array<double, 3> show(const OcioView& ocio, const Vec3f& in) {
  std::array<float, 3> rgb{in.x, in.y, in.z};
  ocio.apply_float(rgb.data(), 1);
  return {rgb[0], rgb[1], rgb[2]};
}

void expect_near(const OcioView& ocio, const Sample& sample, double tolerance) {
  const std::array<double, 3> out = show(ocio, sample.in);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(std::clamp(out[c], 0.0, 1.0), sample.out[c], tolerance)
        << sample.in.x << ' ' << sample.in.y << ' ' << sample.in.z << " channel " << c;
  }
}

// IEC 61966-2-1.
double srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// Grey, colours, shadows and highlights.
constexpr std::array<Vec3f, 9> kColors{{{0, 0, 0},
                                        {0.001F, 0.002F, 0.003F},
                                        {0.18F, 0.18F, 0.18F},
                                        {1, 1, 1},
                                        {0.9F, 0.05F, 0.4F},
                                        {0, 0.5F, 0},
                                        {0, 0, 1},
                                        {3, 2, 0.25F},
                                        {0.02F, 0.6F, 5}}};

TEST(ColorView, SrgbIsTheStandardsCurve) {
  const OcioView ocio(view("sRGB"));
  for (const Vec3f& in : kColors) {
    expect_near(ocio, {in, {srgb(std::min(1.0F, in.x)), srgb(std::min(1.0F, in.y)), srgb(std::min(1.0F, in.z))}}, 2e-5);
  }
}

TEST(ColorView, ReinhardActsOnLuminanceAndKeepsChromaticity) {
  const OcioView ocio(view("Reinhard"));
  for (const Vec3f& in : kColors) {
    const double luminance = 0.2126390059 * static_cast<double>(in.x) + 0.7151686788 * static_cast<double>(in.y) +
                             0.0721923154 * static_cast<double>(in.z);
    const double scale = 1 / (1 + luminance);
    const auto channel = [&](float value) { return srgb(std::min(1.0, scale * static_cast<double>(value))); };
    expect_near(ocio, {in, {channel(in.x), channel(in.y), channel(in.z)}}, 5e-5);
  }
}

TEST(ColorView, RawIsUntouched) {
  const OcioView ocio(view("Raw"));
  for (const Vec3f& in : kColors) {
    const auto out = show(ocio, in);
    EXPECT_EQ(out[0], in.x);
    EXPECT_EQ(out[1], in.y);
    EXPECT_EQ(out[2], in.z);
  }
}

// Reference values from a separate double-precision implementation of the Academy's rendering transform (ACES 1.0.3:
// RRT and ODT Rec.709 100 nits dim: glow, red modifier, splines c5 and c9, dim surround, desaturation, D60 to D65) with
// sRGB's curve at the end. Largest difference seen: 1.0e-5.
TEST(ColorView, AcesIsTheAcademys) {
  const OcioView ocio(ColorSettings{});
  EXPECT_TRUE(ocio.is_builtin_aces());
  constexpr std::array<Sample, 14> kSamples{{{{0.18F, 0.18F, 0.18F}, {0.355954, 0.355954, 0.355954}},
                                             {{0.001F, 0.001F, 0.001F}, {0.0, 0.0, 0.0}},
                                             {{0.01F, 0.01F, 0.01F}, {0.012834, 0.012834, 0.012834}},
                                             {{1, 1, 1}, {0.811971, 0.811971, 0.811971}},
                                             {{4, 4, 4}, {0.955280, 0.955280, 0.955280}},
                                             {{0.5F, 0.1F, 0.05F}, {0.599504, 0.241658, 0.150089}},
                                             {{0.05F, 0.4F, 0.1F}, {0.100913, 0.575805, 0.256421}},
                                             {{0.05F, 0.1F, 0.6F}, {0.086382, 0.229924, 0.687873}},
                                             {{2, 0.3F, 0.1F}, {0.957232, 0.572266, 0.317272}},
                                             {{0.8F, 0.6F, 0.4F}, {0.768527, 0.700934, 0.597839}},
                                             {{0.02F, 0.05F, 0.01F}, {0.040235, 0.127397, 0.017474}},
                                             {{10, 2, 0.5F}, {1.0, 0.922425, 0.791883}},
                                             {{0.9F, 0.05F, 0.4F}, {0.821245, 0.131671, 0.572491}},
                                             {{30, 20, 25}, {1.0, 1.0, 1.0}}}};
  for (const Sample& sample : kSamples) {
    expect_near(ocio, sample, 5e-5);
  }
}

TEST(ColorView, CodeValuesAreRoundedToNearest) {
  const ColorPipeline pipeline(view("Raw"));
  ImageRgb image(256, 1);
  for (int i = 0; i < 256; ++i) {
    // Just below and above the border between two code values, and on one.
    const auto value = static_cast<float>(i);
    image(i, 0) = {(value - 0.49F) / 255, (value + 0.49F) / 255, value / 255};
  }
  const DisplayImage narrow = pipeline.apply(image, 0, 8, 1);
  ASSERT_EQ(narrow.bytes.size(), 256U * 3);
  for (std::size_t i = 0; i < 256; ++i) {
    EXPECT_EQ(narrow.bytes[3 * i], i);
    EXPECT_EQ(narrow.bytes[3 * i + 1], i);
    EXPECT_EQ(narrow.bytes[3 * i + 2], i);
  }
  const DisplayImage wide = pipeline.apply(image, 0, 16, 1);
  ASSERT_EQ(wide.bytes.size(), 256U * 6);
  for (std::size_t i = 0; i < 256; ++i) {
    const unsigned value = wide.bytes[6 * i + 4] | static_cast<unsigned>(wide.bytes[6 * i + 5]) << 8U;
    EXPECT_EQ(value, 257 * i);
  }
}

TEST(ColorView, ExposureIsInStops) {
  const ColorPipeline pipeline(view("Raw"));
  const DisplayImage image = pipeline.apply(ImageRgb(1, 1, {0.25F, 0.125F, 1}), 1.0, 8, 1);
  EXPECT_EQ(image.bytes, (std::vector<std::uint8_t>{128, 64, 255}));
}

TEST(ColorView, ClampsAndCountsWhatTheTransformCannotTake) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const ColorPipeline pipeline{ColorSettings{}};
  ImageRgb image(7, 1, {1e6F, 1e6F, 1e6F});
  image(1, 0) = {kInf, kInf, kInf};
  image(2, 0) = {kNan, kNan, kNan};
  image(3, 0) = {-1, -1, -1};
  image(4, 0) = {1e30F, 1e30F, 1e30F};
  image(5, 0) = {0, 0, -kInf};
  image(6, 0) = {0, 0, 0};
  std::uint64_t clamped = 0;
  const DisplayImage shown = pipeline.apply(image, 0, 8, 1, &clamped);
  EXPECT_EQ(clamped, 5U);
  const std::array<int, 7> expected{255, 255, 0, 0, 255, 0, 0};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(shown.bytes[3 * i + c], expected[i]) << i << ' ' << c;
    }
  }
}

TEST(ColorView, TheSamePictureFromAnyNumberOfThreads) {
  const ColorPipeline pipeline{ColorSettings{}};
  ImageRgb image(301, 97);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto t = static_cast<float>(i) / static_cast<float>(image.pixels.size());
    image.pixels[i] = {t, t * t * 4, 2 - 2 * t};
  }
  for (const int bits : {8, 16}) {
    EXPECT_EQ(pipeline.apply(image, 0.5, bits, 1).bytes, pipeline.apply(image, 0.5, bits, 2).bytes);
  }
}

TEST(ColorView, EmptyAndSinglePixelFrames) {
  const ColorPipeline pipeline{ColorSettings{}};
  EXPECT_TRUE(pipeline.apply(ImageRgb(), 0, 8, 1).bytes.empty());
  EXPECT_EQ(pipeline.apply(ImageRgb(1, 1, {1, 1, 1}), 0, 16, 1).bytes.size(), 6U);
  EXPECT_THROW(static_cast<void>(pipeline.apply(ImageRgb(1, 1), 0, 10, 1)), Error);
}

}  // namespace
}  // namespace gazetrace::color_view_test
