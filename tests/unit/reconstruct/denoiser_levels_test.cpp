// SPDX-License-Identifier: Apache-2.0
// Levels of a frame with blocks of 1, 2 and 4 pixels around a gaze, worked out by hand where a formula is known.
#include "reconstruct/denoiser_levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "foveation/sites.hpp"

namespace gazetrace::denoiser_levels_test {
namespace {

constexpr int kWidth = 203;  // no multiple of a block
constexpr int kHeight = 121;
constexpr int kMiddleX = 100;
constexpr int kMiddleY = 60;

// Squares around the middle: blocks of 1 px within 24 px, of 2 px within 48 px, of 4 px beyond.
SamplingMap nested_map() {
  Layout layout;
  layout.regions = {{"fovea", 1, 4, SampleUnit::per_block},
                    {"intermediate", 2, 4, SampleUnit::per_block},
                    {"periphery", 4, 4, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int away = std::max(std::abs(x - kMiddleX), std::abs(y - kMiddleY));
      layout.region(x, y) = away <= 24 ? 0 : (away <= 48 ? 1 : 2);
    }
  }
  return map_from_layout(std::move(layout));
}

template <class ValueAt>
DenoiserInput input_of(const ValueAt& value_at) {
  DenoiserInput input;
  input.radiance = ImageRgb(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto value = static_cast<float>(value_at(x, y));
      input.radiance(x, y) = {value, 2 * value, -value};
    }
  }
  input.albedo = input.radiance;
  input.normal = input.radiance;
  input.samples = ImageGray(kWidth, kHeight, 0.25F);
  return input;
}

std::vector<ImageRgb> undenoised(const std::vector<DenoiserLevel>& levels) {
  std::vector<ImageRgb> pictures;
  for (const DenoiserLevel& level : levels) {
    pictures.push_back(level.input.radiance);
  }
  return pictures;
}

TEST(DenoiserLevels, OneForEachSizeOfBlocksCoarseToFine) {
  const std::vector<DenoiserLevel> levels = denoiser_levels(input_of([](int, int) { return 1; }), nested_map(), 2);
  ASSERT_EQ(levels.size(), 3U);
  EXPECT_EQ(levels[0].block_px, 4);
  EXPECT_EQ(levels[1].block_px, 2);
  EXPECT_EQ(levels[2].block_px, 1);
  // The periphery lies all around, so its level is the whole frame; the fovea's is its 49 pixels and 16 on each side.
  EXPECT_EQ(levels[0].input.radiance.width_px, 51);
  EXPECT_EQ(levels[0].input.radiance.height_px, 31);
  EXPECT_EQ(levels[2].input.radiance.width_px, 81);
  EXPECT_EQ(levels[2].x_blocks, kMiddleX - 24 - 16);
}

TEST(DenoiserLevels, PixelOfALevelIsTheMeanOfItsBlockInsideTheFrame) {
  const DenoiserInput frame = input_of([](int x, int y) { return x + 1000 * y; });
  const std::vector<DenoiserLevel> levels = denoiser_levels(frame, nested_map(), 1);
  // The block at (12..15, 8..11): the mean of its coordinates.
  EXPECT_FLOAT_EQ(levels[0].input.radiance(3, 2).x, 13.5F + 1000 * 9.5F);
  EXPECT_FLOAT_EQ(levels[0].input.normal(3, 2).y, 2 * (13.5F + 1000 * 9.5F));
  EXPECT_FLOAT_EQ(levels[0].input.samples(3, 2), 16 * 0.25F);
  // The last column has three pixels, 200 to 202, and the last row one, 120.
  EXPECT_FLOAT_EQ(levels[0].input.radiance(50, 30).x, 201 + 1000 * 120);
  EXPECT_FLOAT_EQ(levels[0].input.samples(50, 30), 3 * 0.25F);
}

TEST(DenoiserLevels, BlendOfAnEvenRampIsThatRamp) {
  const SamplingMap map = nested_map();
  const std::vector<DenoiserLevel> levels = denoiser_levels(input_of([](int x, int y) { return x + 3 * y; }), map, 2);
  const ImageRgb frame = blend_levels(levels, undenoised(levels), map, 2);
  // Interpolation of block means is exact for what is linear, but for half a block at the frame's border.
  for (int y = 2; y < kHeight - 3; ++y) {
    for (int x = 2; x < kWidth - 5; ++x) {
      ASSERT_NEAR(frame(x, y).x, x + 3 * y, 1e-3) << x << ", " << y;
    }
  }
}

TEST(DenoiserLevels, FineLevelsShowBehindTheirBorderAndNeverBeyond) {
  const SamplingMap map = nested_map();
  const std::vector<DenoiserLevel> levels = denoiser_levels(input_of([](int, int) { return 1; }), map, 1);
  std::vector<ImageRgb> pictures = undenoised(levels);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::fill(pictures[i].pixels.begin(), pictures[i].pixels.end(), Vec3f{static_cast<float>(i), 0, 0});
  }
  const ImageRgb frame = blend_levels(levels, pictures, map, 1);
  EXPECT_EQ(frame(kMiddleX, kMiddleY).x, 2);
  EXPECT_EQ(frame(kMiddleX + 49, kMiddleY).x, 0);
  EXPECT_EQ(frame(kMiddleX + 25, kMiddleY).x, 1);
  EXPECT_EQ(frame(3, 3).x, 0);
  // From the border inwards it fades in: never less than one pixel further out, and no step larger than the fade
  // allows.
  for (int x = kMiddleX + 1; x < kWidth; ++x) {
    const float step = frame(x - 1, kMiddleY).x - frame(x, kMiddleY).x;
    EXPECT_GE(step, 0) << x;
    EXPECT_LE(step, 0.13) << x;
  }
}

TEST(DenoiserLevels, FineBlocksBesideCoarseOnesShowNothingFromFarAway) {
  // Blocks of 2 px at the left, and of 1 px at the right between those of 4 px.
  Layout layout;
  layout.regions = {{"fine", 1, 4, SampleUnit::per_block},
                    {"middle", 2, 4, SampleUnit::per_block},
                    {"coarse", 4, 4, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kWidth, kHeight, 2);
  for (int y = 40; y < 80; ++y) {
    for (int x = 0; x < 12; ++x) {
      layout.region(x, y) = 1;
    }
    for (int x = 120; x < 160; ++x) {
      layout.region(x, y) = 0;
    }
  }
  const SamplingMap map = map_from_layout(std::move(layout));
  const std::vector<DenoiserLevel> levels = denoiser_levels(input_of([](int x, int y) { return x + 3 * y; }), map, 2);
  const ImageRgb frame = blend_levels(levels, undenoised(levels), map, 2);
  for (int x = 100; x < 180; ++x) {
    ASSERT_NEAR(frame(x, 60).x, x + 3 * 60, 1e-3) << x;
  }
}

TEST(DenoiserLevels, FrameOfSinglePixelsKeepsItsBits) {
  Layout layout;
  layout.regions = {{"uniform", 1, 4, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kWidth, kHeight);
  const SamplingMap map = map_from_layout(std::move(layout));
  const DenoiserInput input = input_of([](int x, int y) { return 0.1 * x + std::sin(y); });
  const std::vector<DenoiserLevel> levels = denoiser_levels(input, map, 2);
  ASSERT_EQ(levels.size(), 1U);
  EXPECT_EQ(levels[0].input.radiance, input.radiance);
  EXPECT_EQ(blend_levels(levels, undenoised(levels), map, 2), input.radiance);
}

}  // namespace
}  // namespace gazetrace::denoiser_levels_test
