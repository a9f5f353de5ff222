// SPDX-License-Identifier: Apache-2.0
// What the terminal is told, by rows whose fronts and ratios are known by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/sweep_row.hpp"
#include "sweep/conclude.hpp"

namespace gazetrace::sweep_text_test {
namespace {

using testing::HasSubstr;

MeasuredRow row_of(const std::string& id, double time_s, double mse, double psnr) {
  MeasuredRow row = row_of_box(id, time_s);
  row.is_foveated = true;
  row.compared_pixels = 10;
  row.runs.front().samples = 20;
  row.runs.front().scores["mse"]["whole"] = mse;
  row.runs.front().scores["psnr"]["whole"] = psnr;
  return row;
}

SweepPlan plan_of() {
  SweepPlan plan;
  plan.measure.repeats = 1;
  plan.measure.comparison.metrics = {"mse", "psnr"};
  return plan;
}

ResultReference reference_of(const std::string& key) {
  ResultReference reference;
  reference.key = key;
  reference.scene = "box";
  reference.floors.push_back({"left", {{"mse", {{"whole", 0.0}}}, {"psnr", {{"whole", 99.0}}}}, {}, {}});
  return reference;
}

Results results_of(const Measurements& measured) {
  Results facts;
  facts.title = "by hand";
  facts.metrics = {{"mse", "", "", true}, {"psnr", "dB", "", false}};
  return conclude(facts, plan_of(), measured);
}

MeasuredRow timed(const std::string& id, RowRole role, const std::vector<double>& times_s,
                  std::optional<double> output_s) {
  MeasuredRow row = row_of(id, 1, 1, 30);
  row.role = role;
  row.runs.resize(times_s.size(), row.runs.front());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    row.runs[i].time_s = times_s[i];
  }
  row.runs.front().output_s = output_s;
  return row;
}

// 8 s and 2 s against 1 s: four times; with 4 s and 3 s of output 12 and 6 against 4.
TEST(SweepText, EndToEndHoldsTheOutputOfTheFirstRepeat) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {timed("fov", RowRole::test, {1, 1}, 3),
                   timed("uniform", RowRole::uniform_reference_rate, {8, 2}, 4)};
  const Results results = results_of(measured);
  const std::string text = results_table(results);
  ASSERT_TRUE(results.rows[0].speed_up.has_value());
  EXPECT_NEAR(results.rows[0].speed_up->mean, 4, 1e-12);
  ASSERT_TRUE(results.rows[0].end_to_end.has_value());
  EXPECT_NEAR(*results.rows[0].end_to_end, std::sqrt(12.0 / 4 * 6 / 4), 1e-12);
  EXPECT_THAT(text, testing::ContainsRegex("\nid +role .* speed-up +end-to-end "));
  EXPECT_THAT(text, testing::ContainsRegex("\nfov +test .*  4 \\([^)]*\\) +2\\.121 "));
  EXPECT_THAT(text, HasSubstr("\nend-to-end: the same with exposure, view and writing of the pictures, without"));
}

TEST(SweepText, WithoutPicturesThereIsNoEndToEndRatio) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {timed("fov", RowRole::test, {1}, 3),
                   timed("uniform", RowRole::uniform_reference_rate, {8}, std::nullopt)};
  EXPECT_FALSE(results_of(measured).rows[0].end_to_end.has_value());
  measured.rows[0].runs.front().output_s.reset();
  EXPECT_THAT(results_table(results_of(measured)), HasSubstr("\nend-to-end: not known, as no pictures were written\n"));
}

// "late" loses to "slow" in both; a wrong gaze is on no front. Less is better of mse, more of psnr: by psnr alone
// "even" is beaten by "fast", which is as good and faster.
TEST(SweepText, TellsTheFrontOfEachMetric) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {row_of("slow", 4, 1, 30), row_of("fast", 1, 4, 20), row_of("late", 5, 2, 25),
                   row_of("even", 2, 3, 20), row_of("wrong", 0.5, 0.5, 40)};
  measured.rows.back().role = RowRole::wrong_gaze;
  const std::string text = results_table(results_of(measured));
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and mse: fast, even, slow\n"));
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and psnr: fast, slow\n"));
}

TEST(SweepText, TellsTheFrontOfEachReference) {
  Measurements measured;
  measured.references = {reference_of("box-a"), reference_of("box-b")};
  measured.rows = {row_of("small", 1, 1, 30), row_of("large", 2, 2, 20)};
  measured.rows[1].reference = "box-b";
  const std::string text = results_table(results_of(measured));
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and mse, reference box-a: small\n"));
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and mse, reference box-b: large\n"));
}

}  // namespace
}  // namespace gazetrace::sweep_text_test
