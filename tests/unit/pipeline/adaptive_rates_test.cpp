// SPDX-License-Identifier: Apache-2.0
// How rates follow from what a pilot found: pooling of its noise, and rates with a given mean within limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "gazetrace/error.hpp"
#include "pipeline/adaptive_rates.hpp"
#include "pipeline/noise_estimate.hpp"
#include "pipeline/time_budget.hpp"

namespace gazetrace {
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

TimingRow frame_of(double samples) {
  TimingRow row;
  row.plan_ms = 1;
  row.guides_ms = 20;
  row.reconstruct_ms = 30;
  row.temporal_ms = 4;
  row.exposure_ms = 1;
  row.layers_ms = 1;
  row.color_ms = 3;
  row.write_ms = 10;
  row.samples = static_cast<std::uint64_t>(samples);
  row.trace_ms = samples * 1e-3;
  return row;
}

TEST(TimeBudget, WhatSamplesLeaveOfAFramesTimeIsItsFixedCost) {
  const FrameCost cost = cost_of(frame_of(5e5));
  EXPECT_DOUBLE_EQ(cost.sample_ms, 1e-3);
  EXPECT_DOUBLE_EQ(cost.fixed_ms, 70);
  // With what is left of 570 ms, the frame would have its samples again.
  EXPECT_DOUBLE_EQ(affordable_spp(570, cost, 1e5, 0.01, 1e6), 5);
}

TEST(TimeBudget, SamplesOfAPilotAreNotPaidTwice) {
  TimingRow row = frame_of(5e5);
  row.pilot_samples = 100000;  // which are among the samples
  row.samples += row.pilot_samples;
  row.pilot_ms = 112;  // 100 of it for samples
  const FrameCost cost = cost_of(row);
  EXPECT_DOUBLE_EQ(cost.sample_ms, 1e-3);
  EXPECT_DOUBLE_EQ(cost.fixed_ms, 82);
  EXPECT_DOUBLE_EQ(affordable_spp(682, cost, 1e5, 0.01, 1e6), 6);
  row.pilot_ms = 50;  // cheaper than the frame's own: never less than no fixed cost
  EXPECT_DOUBLE_EQ(cost_of(row).fixed_ms, 70);
  row.pilot_ms = 0;  // a first look, whose time is part of trace_ms
  EXPECT_DOUBLE_EQ(cost_of(row).sample_ms, 500.0 / 6e5);
  row.learn_ms = 25;  // which no sample pays, and which is no fixed cost: the next frame may know the light already
  row.learning_paths = 65536;
  EXPECT_DOUBLE_EQ(cost_of(row).sample_ms, 500.0 / 6e5);
  EXPECT_DOUBLE_EQ(cost_of(row).fixed_ms, 70);
}

TEST(TimeBudget, AFrameThatTookTwiceAsLongMakesTracingTwiceAsDear) {
  const TimingRow row = frame_of(5e5);  // 500 ms, expected were 250
  const FrameCost cost = cost_of(row, {1, 50, 4e-4}, 100);
  EXPECT_DOUBLE_EQ(cost.fixed_ms, 70);
  EXPECT_DOUBLE_EQ(cost.base_ms, 100);
  EXPECT_DOUBLE_EQ(cost.sample_ms, 8e-4);
}

// A first frame of which a rehearsal left next to nothing once made the next one twice as long.
TEST(TimeBudget, AFrameOfHardlyAnySamplesTellsNothingOfTheirCost) {
  TimingRow row = frame_of(5e5);
  row.pilot_samples = 100000;
  row.samples += row.pilot_samples;
  row.pilot_ms = 112;  // 40 of it for samples, by what they are known to cost
  const FrameCost cost = cost_of(row, {1, 50, 4e-4}, 1.01 * row.trace_ms);
  EXPECT_DOUBLE_EQ(cost.fixed_ms, 142);
  EXPECT_DOUBLE_EQ(cost.base_ms, 50);
  EXPECT_DOUBLE_EQ(cost.sample_ms, 4e-4);
}

// Or a rehearsal that was held up would leave all frames with hardly any samples.
TEST(TimeBudget, AFrameThatWasExpectedToTraceForLongTellsThatItDidNot) {
  FrameCost known{70, 50, 2e-2};  // samples cost a twentieth of that
  const TimingRow row = frame_of(2e4);
  ASSERT_DOUBLE_EQ(row.trace_ms, 20);
  const FrameCost cost = cost_of(row, known, 60);
  EXPECT_NEAR(cost.sample_ms, 2e-2 * 20 / 450, 1e-12);
  // Next to nothing is left of it after six.
  double spp = 0;
  for (int frame = 0; frame < 6; ++frame) {
    spp = affordable_spp(600, known, 1e5, 1.0 / 16, 1e6);
    known = mean_cost(known, cost_of(frame_of(1e5 * spp), known, 60));
  }
  EXPECT_NEAR(spp, 5.3, 0.2);
}

TEST(TimeBudget, ASampleCostsWhatMoreOfThemTakeLonger) {
  // 20 ms and 1 microsecond a sample.
  const FrameCost cost = with_slope({50, 0, 1.2e-3}, {120, 1e5}, {45, 2.5e4});
  EXPECT_NEAR(cost.sample_ms, 1e-3, 1e-12);
  EXPECT_NEAR(cost.base_ms, 20, 1e-9);
  EXPECT_NEAR(affordable_spp(1070, cost, 1e5, 0.01, 1e6), 10, 1e-9);
  // Where chance has the fewer take longer, or the more no longer, nobody believes it.
  EXPECT_NEAR(with_slope({50, 0, 0}, {120, 1e5}, {130, 2.5e4}).sample_ms, 0.4 * 1.2e-3, 1e-12);
  EXPECT_NEAR(with_slope({50, 0, 0}, {120, 1e5}, {0, 2.5e4}).sample_ms, 1.2e-3, 1e-12);
  EXPECT_NEAR(with_slope({50, 0, 0}, {120, 1e5}, {0, 2.5e4}).base_ms, 0, 1e-9);
}

TEST(TimeBudget, AFilterThatTakesLongerForMoreSamplesIsPaid) {
  // 70 ms with 1e4 samples and a fifth of a microsecond for each further one up to 1e5, beside 1 for tracing it.
  const FrameCost cost{70, 0, 1e-3, 1e4, 0.2};
  const double few = affordable_spp(130, cost, 1e5, 0.01, 1e6);
  EXPECT_LT(few, 1);
  EXPECT_NEAR(70 + 2e-4 * (1e5 * few - 1e4) + 1e-3 * 1e5 * few, 130, 1e-9);
  const double many = affordable_spp(670, cost, 1e5, 0.01, 1e6);
  EXPECT_GT(many, 1);
  EXPECT_NEAR(70 + 2e-4 * (1e5 - 1e4) + 1e-3 * 1e5 * many, 670, 1e-9);
  EXPECT_NEAR(affordable_spp(188, cost, 1e5, 0.01, 1e6), 1, 1e-9);
  EXPECT_NEAR(affordable_spp(500, {10, 0, 1e-3, 1e7, 0.2}, 1e5, 0.01, 1e6), 4.8,
              1e-9);  // never less than no fixed cost
  const FrameCost next = cost_of(frame_of(5e5), cost, 100);
  EXPECT_EQ(next.samples, 5e5);
  EXPECT_EQ(next.filter_share, 0.2);
  // As many samples again leave as much time again.
  EXPECT_NEAR(affordable_spp(570, next, 1e5, 0.01, 1e6), 5, 1e-9);
}

TEST(TimeBudget, RatesKeepTheirLimits) {
  const FrameCost cost{60, 40, 1e-3};
  EXPECT_DOUBLE_EQ(affordable_spp(99, cost, 1e4, 0.5, 64), 0.5);  // not even the fixed cost
  EXPECT_DOUBLE_EQ(affordable_spp(1e9, cost, 1e4, 0.5, 64), 64);
  EXPECT_DOUBLE_EQ(affordable_spp(1e9, {0, 0, 0}, 1e4, 0.5, 64), 64);  // nothing was measured
  EXPECT_DOUBLE_EQ(affordable_spp(99, cost, 1e4, 8, 4), 4);
  const FrameCost mean = mean_cost(cost, {300, 10, 3e-3});
  EXPECT_DOUBLE_EQ(mean.fixed_ms, 180);
  EXPECT_DOUBLE_EQ(mean.base_ms, 16);  // which became less: 2 / (1 / 40 + 1 / 10)
  EXPECT_DOUBLE_EQ(mean.sample_ms, 2e-3);
}

TEST(TimeBudget, TheLeastRateLeavesMoreThanThePilot) {
  FrameRequest request;
  request.width_px = 64;
  request.height_px = 40;
  FoveationSettings settings;
  settings.falloff = "visible";
  settings.budget_spp = least_budget_spp(settings, request);
  EXPECT_NO_THROW(check_pilot_budget(settings, request));
  settings.budget_spp = 0.75 * *settings.budget_spp;
  EXPECT_THROW(check_pilot_budget(settings, request), Error);
  settings.falloff = "uniform";
  settings.min_spp = 3;
  EXPECT_EQ(least_budget_spp(settings, request), 3);
}

}  // namespace
}  // namespace gazetrace
