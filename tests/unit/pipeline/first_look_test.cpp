// SPDX-License-Identifier: Apache-2.0
// What a first look at the frame says of contrast: nothing of noise, all of edges.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>

#include "pipeline/first_look.hpp"

namespace gazetrace {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr std::uint32_t kSpp = 4;

SamplingMap uniform_map() {
  FoveationSettings settings;
  settings.uniform_spp = kSpp;
  return make_sampling_map(settings, view_of_perspective(1, kWidth, kHeight), std::nullopt);
}

// Samples of brightness level(x, y) times a factor of mean 1 and standard deviation `noise`.
template <class Level>
SparseFrame sample(const SamplingMap& map, double noise, const Level& level) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> factor(1, noise);
  SparseFrame frame;
  frame.width_px = kWidth;
  frame.height_px = kHeight;
  for (const Site& site : map.sites) {
    double sum = 0;
    double square = 0;
    for (std::uint32_t i = 0; i < kSpp; ++i) {
      const double value = level(site.block_x, site.block_y) * (noise > 0 ? factor(random) : 1.0);
      sum += value;
      square += value * value;
    }
    frame.sum.push_back(Vec3f{1, 1, 1} * static_cast<float>(sum));
    frame.sum_square_luminance.push_back(static_cast<float>(square));
    frame.count.push_back(kSpp);
  }
  return frame;
}

double mean(const ImageGray& image) {
  double sum = 0;
  for (const float value : image.pixels) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(image.pixels.size());
}

TEST(FirstLook, EdgesAreSeenAndFlatPartsAreNot) {
  const SamplingMap map = uniform_map();
  const ImageGray contrast = local_contrast(sample(map, 0, [](int x, int) { return x < 20 ? 0.2 : 0.6; }), map);
  EXPECT_NEAR(contrast(5, 5), 0, 1e-4);
  EXPECT_NEAR(contrast(35, 5), 0, 1e-4);
  // Six pixels of 0.2 and three of 0.6: mean 1/3, variance (6 (2/15)^2 + 3 (4/15)^2) / 8 = 0.04.
  EXPECT_NEAR(contrast(19, 5), 0.2 / (1.0 / 3), 1e-5);
  const ImageGray multiplier = contrast_multiplier(contrast, 1);
  EXPECT_NEAR(multiplier(5, 5), 0.25, 1e-3);
  EXPECT_EQ(multiplier(19, 5), 1.0F);
  EXPECT_NEAR(contrast_multiplier(contrast, 0.4)(5, 5), 1 - 0.3, 1e-3);
}

// Of pure noise of 40 % a sample, 20 % a mean of four: what is left must be far below that.
TEST(FirstLook, NoiseIsTakenOff) {
  const SamplingMap map = uniform_map();
  const ImageGray noisy = local_contrast(sample(map, 0.4, [](int, int) { return 0.5; }), map);
  EXPECT_LT(mean(noisy), 0.08);
  // ... and real contrast stays what it is: a checkerboard of 0.25 and 0.75, standard deviation half the mean.
  const ImageGray checks =
      local_contrast(sample(map, 0.4, [](int x, int y) { return (x + y) % 2 == 0 ? 0.25 : 0.75; }), map);
  EXPECT_NEAR(mean(checks), 0.5 * std::sqrt(9.0 / 8) * std::sqrt(80.0 / 81), 0.06);
}

TEST(FirstLook, BlackAndUnsampledFramesHaveNone) {
  const SamplingMap map = uniform_map();
  SparseFrame black = sample(map, 0, [](int, int) { return 0.0; });
  for (const float value : local_contrast(black, map).pixels) {
    EXPECT_EQ(value, 0.0F);
  }
  black.count.assign(black.count.size(), 0);
  for (const float value : local_contrast(black, map).pixels) {
    EXPECT_EQ(value, 0.0F);
  }
}

}  // namespace
}  // namespace gazetrace
