// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "gazetrace/color.hpp"

namespace gazetrace::exposure_test {
namespace {

double measure(const ImageRgb& image, ExposureSettings settings = {ExposureMode::log_average}) {
  return choose_exposure_ev(image, settings);
}

TEST(Exposure, FixedIsWhatItSays) {
  EXPECT_EQ(choose_exposure_ev(ImageRgb(4, 4, {9, 9, 9}), {ExposureMode::fixed, -1.5}), -1.5);
}

TEST(Exposure, AConstantFrameIsBroughtToTheKey) {
  // Luminance 0.36 is twice the key 0.18: one stop down.
  EXPECT_NEAR(measure(ImageRgb(64, 48, {0.36F, 0.36F, 0.36F})), -1.0, 1e-6);
  // The weights are Rec.709's: pure green of 1 has luminance 0.7152.
  EXPECT_NEAR(measure(ImageRgb(64, 48, {0, 1, 0})), std::log2(0.18 / 0.7152), 1e-6);
  ExposureSettings settings{ExposureMode::log_average};
  settings.key = 0.36;
  settings.ev = 0.25;
  EXPECT_NEAR(measure(ImageRgb(64, 48, {0.36F, 0.36F, 0.36F}), settings), 0.25, 1e-6);
}

TEST(Exposure, BlocksCountByTheLogarithmOfTheirMeans) {
  // 47 x 16 pixels: two blocks, of 16 and of 31 columns, and the geometric mean of 1 and 4 is 2.
  ImageRgb image(47, 16, {1, 1, 1});
  for (int y = 0; y < 16; ++y) {
    for (int x = 16; x < 47; ++x) {
      image(x, y) = {4, 4, 4};
    }
  }
  EXPECT_NEAR(measure(image), std::log2(0.18 / 2), 1e-6);
  // 31 columns make one block: the mean (16 * 1 + 15 * 4) / 31 itself.
  ImageRgb narrow(31, 16, {1, 1, 1});
  for (int y = 0; y < 16; ++y) {
    for (int x = 16; x < 31; ++x) {
      narrow(x, y) = {4, 4, 4};
    }
  }
  EXPECT_NEAR(measure(narrow), std::log2(0.18 * 31 / 76), 1e-6);
}

TEST(Exposure, NoiseDoesNotDarkenOrBrighten) {
  // Half of the pixels black, half twice as bright: the log-average of pixels would be 0.
  std::mt19937 generator(7);
  ImageRgb image(128, 128);
  for (Vec3f& pixel : image.pixels) {
    const float value = (generator() & 1U) != 0 ? 0.36F : 0.0F;
    pixel = {value, value, value};
  }
  // Block means of 256 coin flips spread by 6 %; the log of their mean errs by 0.2 %.
  EXPECT_NEAR(measure(image), 0.0, 0.03);
}

TEST(Exposure, BlackBlocksAreLeftOut) {
  ImageRgb image(32, 16, {0, 0, 0});
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      image(x, y) = {0.18F, 0.18F, 0.18F};
    }
  }
  EXPECT_NEAR(measure(image), 0.0, 1e-6);
}

TEST(Exposure, IsFiniteWhateverTheFrame) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kMax = std::numeric_limits<float>::max();
  EXPECT_EQ(measure(ImageRgb(64, 64)), 0.0);
  EXPECT_EQ(measure(ImageRgb()), 0.0);
  EXPECT_NEAR(measure(ImageRgb(1, 1, {0.18F, 0.18F, 0.18F})), 0.0, 1e-6);
  EXPECT_NEAR(measure(ImageRgb(3, 200, {0.18F, 0.18F, 0.18F})), 0.0, 1e-6);
  for (const float value : {kInf, -kInf, kNan, -1.0F, kMax}) {
    EXPECT_TRUE(std::isfinite(measure(ImageRgb(33, 33, {value, value, value})))) << value;
  }
}

}  // namespace
}  // namespace gazetrace::exposure_test
