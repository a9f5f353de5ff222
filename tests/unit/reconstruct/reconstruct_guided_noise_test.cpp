// SPDX-License-Identifier: Apache-2.0
// What the guided filter makes of noise of known strength on light that its guides do not show: it must not be worse
// than the samples' own mean, must tend to it, and must know how far off it is.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "support/guides_wall.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace::reconstruct_guided_noise_test {
namespace {

constexpr int kSize = kGuidesWallPx;
constexpr std::uint32_t kSamples = 16;

// Light that no first hit tells of: stripes of two pixels in one quarter, a soft slope in another, even elsewhere.
double striped_light(int x, int y) {
  if (x < kSize / 2 && y < kSize / 2) {
    return (x / 2) % 2 == 0 ? 1.3 : 0.7;
  }
  return x >= kSize / 2 && y >= kSize / 2 ? 0.5 + static_cast<double>(x) / kSize : 1.0;
}
double even_light(int, int) {
  return 1;
}

struct Errors {
  double raw = 0, filtered = 0;  // mean square errors of luminance
  double estimated = 0;          // mean of Frame::squared_error
};

// Pixels far apart whose own samples agree, amid noise: they are brighter than what is around them.
bool is_quiet(int x, int y) {
  return x % 16 == 5 && y % 16 == 3;
}
double quiet_lights(int x, int y) {
  return is_quiet(x, y) ? 2 : 1;
}

struct Pixels {
  double share_of_sigma = 1;  // of the others' noise in quiet pixels
  bool quiet_alone = false;   // errors are those of quiet pixels
};

// `of_all`: standard deviation of the mean of a pixel's samples.
template <class LightAt>
Errors errors_at(double of_all, const LightAt& light_at, const Pixels& pixels = {}) {
  const Guides guides = wall();
  const SamplingMap map = map_with_fovea({0, kSize}, {0, kSize}, kSamples, 4);
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, std::sqrt(2.0));  // of half the samples
  SparseFrame sparse;
  sparse.width_px = kSize;
  sparse.height_px = kSize;
  Errors errors;
  for (const Site& site : map.sites) {
    const int x = site.block_x;
    const int y = site.block_y;
    const double sigma = of_all * (is_quiet(x, y) ? pixels.share_of_sigma : 1.0);
    const double a = light_at(x, y) + sigma * noise(random);
    const double b = light_at(x, y) + sigma * noise(random);
    const double mean = (a + b) / 2;
    const double spread = sigma * sigma * kSamples;  // of the samples
    const auto n = static_cast<float>(kSamples);
    const auto reflected = static_cast<float>(0.5 * mean);
    SurfaceSums surface;
    surface.reflected = n * Vec3f{reflected, reflected, reflected};
    surface.albedo = n * Vec3f{0.5F, 0.5F, 0.5F};
    surface.normal = n * Vec3f{0, 0, 1};
    surface.position_m = n * guides.camera.place(static_cast<float>(x) + 0.5F - 0.5F * kSize,
                                                 static_cast<float>(y) + 0.5F - 0.5F * kSize, 10);
    surface.square = static_cast<float>(kSamples * (mean * mean + spread));
    surface.half_difference = static_cast<float>(0.5 * (a - b) / 2);
    surface.count = kSamples;
    sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
    sparse.surfaces.push_back(surface);
    sparse.sum.push_back(surface.reflected);
    sparse.count.push_back(kSamples);
    sparse.sum_square_luminance.push_back(0.25F * surface.square);
    sparse.half_difference.push_back(surface.half_difference);
    const bool counts = !pixels.quiet_alone || is_quiet(x, y);
    errors.raw += counts ? 0.25 * (mean - light_at(x, y)) * (mean - light_at(x, y)) : 0;
  }
  sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
  const Frame frame = reconstruct(sparse, map, "guided", 1, &guides);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double off = static_cast<double>(frame.radiance(x, y).y) - 0.5 * light_at(x, y);
      errors.filtered += !pixels.quiet_alone || is_quiet(x, y) ? off * off : 0;
      errors.estimated += static_cast<double>(frame.squared_error(x, y));
    }
  }
  const double count = pixels.quiet_alone ? kSize * kSize / 256 : kSize * kSize;
  return {errors.raw / count, errors.filtered / count, errors.estimated / count};
}

TEST(ReconstructGuidedNoise, ItIsNeverWorseThanTheMeanOfTheSamples) {
  for (const double sigma : {1.0, 0.3, 0.1, 0.03, 0.01, 0.001}) {
    const Errors errors = errors_at(sigma, striped_light);
    EXPECT_LT(errors.filtered, 1.01 * errors.raw) << sigma;
  }
}

// The noise around hides that the smoothing is wrong there, by 1. With 16 samples and a variance v of their mean, 12 v
// of it is left: beside their own error of 0.01 that is little. Albedo halves both, and they are squared.
TEST(ReconstructGuidedNoise, WhatAPixelIsSureOfIsNotHiddenByNoiseAroundIt) {
  const Errors errors = errors_at(1, quiet_lights, {0.01, true});
  EXPECT_LT(errors.filtered, 4 * 0.25e-4);
}

TEST(ReconstructGuidedNoise, EvenLightLosesMostOfItsNoise) {
  for (const double sigma : {1.0, 0.3, 0.1, 0.01}) {
    const Errors errors = errors_at(sigma, even_light);
    EXPECT_LT(errors.filtered, 0.1 * errors.raw) << sigma;
  }
}

TEST(ReconstructGuidedNoise, TheEstimateOfItsErrorIsWithinAFactorOfThree) {
  for (const double sigma : {0.3, 0.1, 0.03, 0.01}) {
    const Errors errors = errors_at(sigma, striped_light);
    EXPECT_LT(errors.estimated, 3 * errors.filtered) << sigma;
    EXPECT_GT(errors.estimated, errors.filtered / 3) << sigma;
  }
}

}  // namespace
}  // namespace gazetrace::reconstruct_guided_noise_test
