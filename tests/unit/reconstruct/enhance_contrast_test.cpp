// SPDX-License-Identifier: Apache-2.0
// Contrast preservation against closed forms of waves and of what blocks take from them.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "core/luminance.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {
namespace {

constexpr int kWidth = 512, kHeight = 64;

SamplingMap map_of_blocks(int left_px, int right_px) {
  SamplingMap map;
  map.width_px = kWidth;
  map.height_px = kHeight;
  map.region = Image<std::uint8_t>(kWidth, kHeight);
  map.regions.resize(2);
  map.regions[0].block_px = left_px;
  map.regions[1].block_px = right_px;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 2; x < kWidth; ++x) {
      map.region(x, y) = 1;
    }
  }
  return map;
}

template <class LogOfX>
ImageRgb picture(const LogOfX& log_of_x) {
  ImageRgb image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image(x, y) = Vec3f{0.6F, 1.0F, 1.7F} * static_cast<float>(std::exp(log_of_x(x + 0.5)));
    }
  }
  return image;
}

// Amplitude of a wave in the logarithm of luminance, over whole periods in the middle of the picture.
double amplitude(const ImageRgb& image, double cycles_per_px) {
  const int periods = static_cast<int>(256 * cycles_per_px);
  const int count = static_cast<int>(std::lround(periods / cycles_per_px));
  std::complex<double> sum = 0;
  for (int k = 0; k < count; ++k) {
    const int x = 128 + k;
    sum += std::log(static_cast<double>(luminance(image(x, kHeight / 2)))) *
           std::polar(1.0, -2 * kPi * cycles_per_px * (x + 0.5));
  }
  return 2 * std::abs(sum) / count;
}

// (pi/4 / sin(pi/4))^3, what a box of n pixels and a tent of 2n take from f = 1 / (4 n).
constexpr double kLost = 1.3702276;

TEST(EnhanceContrast, RaisesHalfTheLimitByWhatBlocksTook) {
  for (const int block : {2, 4, 8, 16}) {
    const double f = 1.0 / (4 * block);
    const SamplingMap map = map_of_blocks(block, block);
    const ImageRgb wave = picture([&](double x) { return -3 + 0.2 * std::sin(2 * kPi * f * x); });
    EXPECT_NEAR(amplitude(wave, f), 0.2, 1e-4);
    // The Gaussian ends at three deviations and is sampled at whole pixels.
    EXPECT_NEAR(amplitude(enhance_contrast(wave, map, 1), f), 0.2 * kLost, 0.2 * 0.01) << block;
    EXPECT_NEAR(amplitude(enhance_contrast(wave, map, 0.5), f), 0.2 * (1 + (kLost - 1) / 2), 0.2 * 0.01) << block;
  }
}

TEST(EnhanceContrast, GivesBackAWaveThatBlocksHaveBlurred) {
  constexpr int kBlock = 4;
  const double f = 1.0 / (4 * kBlock);
  const auto wave = [&](double x) { return 0.02 * std::sin(2 * kPi * f * x); };
  // A wave so weak that its logarithm is as good as linear: means of blocks, straight lines between their middles.
  const auto block_mean = [&](int block) {
    double sum = 0;
    for (int k = 0; k < 1000; ++k) {
      sum += wave(kBlock * (block + (k + 0.5) / 1000));
    }
    return sum / 1000;
  };
  const ImageRgb blurred = picture([&](double x) {
    const double at = x / kBlock - 0.5;
    const int block = static_cast<int>(std::floor(at));
    return block_mean(block) + (at - block) * (block_mean(block + 1) - block_mean(block));
  });
  EXPECT_NEAR(amplitude(blurred, f), 0.02 / kLost, 0.02 * 0.01);
  EXPECT_NEAR(amplitude(enhance_contrast(blurred, map_of_blocks(kBlock, kBlock), 1), f), 0.02, 0.02 * 0.015);
}

TEST(EnhanceContrast, PixelsOfTheirOwnStayToTheBit) {
  const ImageRgb image = picture([](double x) { return std::sin(0.3 * x) + 0.4 * std::sin(2 * x); });
  const ImageRgb out = enhance_contrast(image, map_of_blocks(1, 4), 1);
  bool changed = false;
  for (int x = 0; x < kWidth; ++x) {
    if (x < kWidth / 2) {
      EXPECT_EQ(out(x, 9), image(x, 9)) << x;
    } else {
      changed = changed || !(out(x, 9) == image(x, 9));
      EXPECT_NEAR(out(x, 9).x / out(x, 9).y, 0.6, 1e-5);
      EXPECT_NEAR(out(x, 9).z / out(x, 9).y, 1.7, 1e-5);
    }
  }
  EXPECT_TRUE(changed);
  EXPECT_EQ(enhance_contrast(image, map_of_blocks(4, 4), 0), image);
}

TEST(EnhanceContrast, EvenAndBlackPicturesStay) {
  const ImageRgb even = picture([](double) { return 2.0; });
  const ImageRgb out = enhance_contrast(even, map_of_blocks(2, 16), 1);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    EXPECT_NEAR(out.pixels[i].y / even.pixels[i].y, 1, 1e-5);
  }
  const ImageRgb black(kWidth, kHeight);
  EXPECT_EQ(enhance_contrast(black, map_of_blocks(2, 16), 1), black);
}

TEST(EnhanceContrast, ABrightSampleIsNotRaisedWithoutBounds) {
  ImageRgb image = picture([](double) { return 0.0; });
  image(300, 30) = image(300, 30) * 1e12F;
  image(200, 30) = {};
  const ImageRgb out = enhance_contrast(image, map_of_blocks(4, 4), 1);
  EXPECT_NEAR(out(300, 30).y / image(300, 30).y, std::exp(2 * contrast_gain(1)), 1e-3);
  EXPECT_EQ(out(200, 30), Vec3f{});
  for (const Vec3f& pixel : out.pixels) {
    ASSERT_TRUE(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
  }
}

TEST(EnhanceContrast, RefusesWhatMakesNoSense) {
  const ImageRgb image(kWidth, kHeight);
  EXPECT_THROW(enhance_contrast(image, map_of_blocks(1, 2), -0.1), Error);
  EXPECT_THROW(enhance_contrast(image, map_of_blocks(1, 2), std::nan("")), Error);
  EXPECT_THROW(enhance_contrast(ImageRgb(2, 2), map_of_blocks(1, 2), 1), Error);
}

// As if such pixels lay beyond the border: they stay as they are, and an even neighbourhood stays even.
TEST(EnhanceContrast, PixelsThatAreNoNumbersStayAndSpoilNoOthers) {
  const float infinity = std::numeric_limits<float>::infinity();
  ImageRgb image = picture([](double) { return 0.5; });
  const ImageRgb even = image;
  image(300, 30) = {infinity, infinity, infinity};
  image(310, 30) = {std::nanf(""), 1, 1};
  for (int x = 400; x < 440; ++x) {  // farther than the Gaussian reaches
    for (int y = 0; y < kHeight; ++y) {
      image(x, y) = {1, -infinity, 1};
    }
  }
  const ImageRgb out = enhance_contrast(image, map_of_blocks(4, 4), 1);
  EXPECT_EQ(out(300, 30), image(300, 30));
  EXPECT_TRUE(std::isnan(out(310, 30).x));
  EXPECT_EQ(out(310, 30).y, 1);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    if (image.pixels[i] == even.pixels[i]) {
      ASSERT_NEAR(out.pixels[i].y / even.pixels[i].y, 1, 1e-5) << i;
    } else {
      ASSERT_FALSE(std::isfinite(luminance(out.pixels[i]))) << i;
    }
  }
  const ImageRgb nothing(kWidth, kHeight, {infinity, infinity, infinity});
  EXPECT_EQ(enhance_contrast(nothing, map_of_blocks(4, 4), 1), nothing);
}

}  // namespace
}  // namespace gazetrace
