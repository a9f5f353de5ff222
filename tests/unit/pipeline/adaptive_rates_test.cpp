// SPDX-License-Identifier: Apache-2.0
// How rates follow from what a pilot found: pooling of its noise, and rates with a given mean within limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "gazetrace/error.hpp"
#include "pipeline/quality/adaptive_rates.hpp"
#include "pipeline/quality/visible_noise.hpp"

namespace gazetrace::adaptive_rates_test {
namespace {

double mean(const ImageGray& image) {
  double sum = 0;
  for (const float value : image.pixels) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(image.pixels.size());
}

ImageGray heavy_tails(int width, int height) {
  std::mt19937 random(4);
  std::lognormal_distribution<float> value(0, 1.5F);
  ImageGray image(width, height);
  for (float& pixel : image.pixels) {
    pixel = value(random);
  }
  return image;
}

TEST(NoiseEstimate, PlainFieldsStayWhatTheyAre) {
  const ImageGray even = pooled(ImageGray(20, 9, 0.3F));
  for (const float value : even.pixels) {
    ASSERT_FLOAT_EQ(value, 0.3F);
  }
  for (const float value : pooled(ImageGray(20, 9, 0)).pixels) {
    ASSERT_EQ(value, 0.0F);
  }
}

TEST(NoiseEstimate, OneFireflyNeitherRulesItsSurroundingsNorVanishes) {
  ImageGray field(20, 20, 1);
  field(10, 10) = 1e8F;
  const ImageGray smooth = pooled(field);
  EXPECT_NEAR(smooth(10, 10), (24 + kMostOfOthers) / 25, 1e-5);
  EXPECT_EQ(smooth(2, 2), 1.0F);
  // Many of them are what the place is like.
  for (int y = 8; y < 13; ++y) {
    for (int x = 8; x < 13; ++x) {
      field(x, y) = 1e8F;
    }
  }
  EXPECT_NEAR(pooled(field)(10, 10) / 1e8, 1, 1e-5);
}

TEST(NoiseEstimate, WhatIsNotFiniteIsLeftOutAndWhatIsNegativeCountsAsNothing) {
  ImageGray field(6, 6, 2);
  field(3, 3) = std::numeric_limits<float>::quiet_NaN();
  field(1, 1) = std::numeric_limits<float>::infinity();
  for (const float value : pooled(field).pixels) {
    ASSERT_EQ(value, 2.0F);
  }
  field(5, 5) = -3;
  EXPECT_EQ(pooled(field)(5, 5), 2 * 7.0F / 8);  // of nine pixels one is not known, and one counts as 0
  EXPECT_EQ(pooled(ImageGray(4, 4, std::numeric_limits<float>::infinity())), ImageGray(4, 4, 0));
}

TEST(NoiseEstimate, SameBitsForAnyNumberOfThreads) {
  const ImageGray field = heavy_tails(61, 47);
  EXPECT_EQ(pooled(field, 1), pooled(field, 3));
}

TEST(RatesBetween, MeetTheirMeanAndKeepProportionsWithinTheirLimits) {
  const ImageGray wanted = heavy_tails(64, 36);
  for (const double spp : {0.3, 1.0, 7.5, 300.0}) {
    const ImageGray free = rates_between(wanted, spp, 0, 1e9);
    EXPECT_NEAR(mean(free) / spp, 1, 1e-6);
    EXPECT_NEAR(free(5, 5) / free(7, 9), wanted(5, 5) / wanted(7, 9), 1e-4);
    const ImageGray bound = rates_between(wanted, spp, spp / 2, 2 * spp);
    EXPECT_NEAR(mean(bound) / spp, 1, 1e-6);
    EXPECT_EQ(*std::min_element(bound.pixels.begin(), bound.pixels.end()), static_cast<float>(spp / 2));
    EXPECT_EQ(*std::max_element(bound.pixels.begin(), bound.pixels.end()), static_cast<float>(2 * spp));
  }
}

TEST(RatesBetween, WhereNothingIsWantedOrLimitsForbidItRatesAreEven) {
  for (const float value : rates_between(ImageGray(8, 8, 0), 3, 0, 100).pixels) {
    ASSERT_EQ(value, 3.0F);
  }
  for (const float value : rates_between(heavy_tails(8, 8), 3, 5, 100).pixels) {
    ASSERT_EQ(value, 3.0F);
  }
  for (const float value : rates_between(heavy_tails(8, 8), 3, 0, 2).pixels) {
    ASSERT_EQ(value, 3.0F);
  }
}

TEST(PilotBudget, MustLeaveMoreThanThePilot) {
  FrameRequest request;
  request.width_px = 64;
  request.height_px = 40;
  FoveationSettings settings;
  settings.sampling = AdaptiveSampling{};
  settings.spp = 1.25 * least_pilot_spp(request);
  EXPECT_NO_THROW(check_pilot_budget(settings, request));
  settings.spp = 0.95 * least_pilot_spp(request);
  EXPECT_THROW(check_pilot_budget(settings, request), Error);
}

}  // namespace
}  // namespace gazetrace::adaptive_rates_test
