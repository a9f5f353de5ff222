// SPDX-License-Identifier: Apache-2.0
// How many samples a reference needs follows from how it is known, and from nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/error.hpp"
#include "sweep/certainty.hpp"

namespace gazetrace::sweep_certainty_test {
namespace {

using testing::HasSubstr;

ResultFloor floor_of(const std::string& metric, double score) {
  ResultFloor floor;
  floor.gaze = "left";
  floor.scores[metric]["whole"] = score;
  return floor;
}

SweepPlan plan_of(const std::string& metric, double level) {
  SweepPlan plan;
  plan.plan_file = "plan.toml";
  plan.scenes.emplace_back();
  plan.scenes.back().name = "room";
  plan.measure.fixed_quality = {{metric, level}};
  return plan;
}

TEST(Certainty, ErrorsFallWithTheSamplesAsTheirVarianceDoes) {
  EXPECT_NEAR(samples_needed("mse", 0.04, 0.01, 100), 400, 1e-9);   // a squared error is the variance
  EXPECT_NEAR(samples_needed("psnr", 30, 40, 100), 1000, 1e-6);     // ten decibels are a factor of ten
  EXPECT_NEAR(samples_needed("flip", 0.15, 0.05, 100), 900, 1e-9);  // an amplitude
}

TEST(Certainty, NoNoiseMovesNoScoreAndMoreMovesItMore) {
  EXPECT_NEAR(moved_jod(10, 9), 0, 1e-12);
  EXPECT_LT(moved_jod(9.9, 9), moved_jod(9.5, 9));
  EXPECT_LT(moved_jod(9.5, 8), moved_jod(9.5, 9));  // what is worse is moved less
  EXPECT_GT(moved_jod(6.5, 9.5), 0.1);
}

TEST(Certainty, TheSamplesThatAreAskedForMoveTheScoreByATenth) {
  // What is lacking to 10 JOD falls with one power of the samples; it is read off two of the answers.
  const double power =
      std::log(3.0 / 1.5) / std::log(samples_needed("fovvideovdp", 7, 9, 1) / samples_needed("fovvideovdp", 8.5, 9, 1));
  EXPECT_GT(power, 0.4);
  EXPECT_LT(power, 0.75);
  for (const double level : {8.0, 9.0, 9.5}) {
    const double factor = samples_needed("fovvideovdp", 6.5, level, 1);
    EXPECT_NEAR(moved_jod(10 - 3.5 * std::pow(factor, -power), level), 0.1, 1e-9) << level;
  }
}

TEST(Certainty, NextAttemptsEnd) {
  const SweepMeasure measure = plan_of("fovvideovdp", 9).measure;
  EXPECT_FALSE(next_samples(measure, {floor_of("fovvideovdp", 9.95)}, 64, 8192));
  EXPECT_FALSE(next_samples(measure, {floor_of("fovvideovdp", 6)}, 8192, 8192));
  EXPECT_EQ(next_samples(measure, {floor_of("fovvideovdp", 6)}, 64, 100), 100);
  double spp = 64;
  int attempts = 0;
  while (const auto more =
             next_samples(measure, {floor_of("fovvideovdp", 10 - 3.5 * std::pow(64 / spp, 0.4))}, spp, 1e9)) {
    EXPECT_GE(*more, 2 * spp);
    spp = *more;
    ASSERT_LT(++attempts, 20);
  }
}

TEST(Certainty, ASweepThatCanTellNoLevelEndsWithTheWayOut) {
  SweepPlan plan = plan_of("fovvideovdp", 9);
  SweepReference reference;
  reference.seeds = {1, 2, 3, 4};
  EXPECT_NO_THROW(check_levels(plan, reference, {floor_of("fovvideovdp", 9.2)}, 512));
  EXPECT_NO_THROW(check_levels(plan, reference, {floor_of("mse", 0.1)}, 512));  // nothing is asked of it
  try {
    check_levels(plan, reference, {floor_of("fovvideovdp", 6.5)}, 512);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    for (const char* words : {"plan.toml", "room has 512 samples", "known to fovvideovdp 6.5", "levels are 9",
                              "samples would do", "go-on"}) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }
  plan.go_on = true;
  EXPECT_NO_THROW(check_levels(plan, reference, {floor_of("fovvideovdp", 6.5)}, 512));
}

}  // namespace
}  // namespace gazetrace::sweep_certainty_test
