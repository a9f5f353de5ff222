// SPDX-License-Identifier: Apache-2.0
// What the terminal is told, by rows whose fronts and ratios are known by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/sweep_row.hpp"
#include "sweep/tables.hpp"

namespace gazetrace {
namespace {

using testing::HasSubstr;

SweepRow row_of(const std::string& id, double time_s, double mse, double psnr) {
  SweepRow row = row_of_box(id, time_s);
  row.is_foveated = true;
  row.compared_pixels = 10;
  row.runs.front().samples = 20;
  row.runs.front().scores["mse"]["whole"] = mse;
  row.runs.front().scores["psnr"]["whole"] = psnr;
  return row;
}

SweepPlan plan_of() {
  SweepPlan plan;
  plan.title = "by hand";
  plan.measure.repeats = 1;
  plan.measure.comparison.metrics = {"mse", "psnr"};
  return plan;
}

SweepReferenceResult reference_of(const std::string& key) {
  SweepReferenceResult reference;
  reference.key = key;
  reference.scene = "box";
  reference.floors.push_back({"left", {{"mse", {{"whole", 0.0}}}, {"psnr", {{"whole", 99.0}}}}, {}, {}});
  return reference;
}

std::string table_of(SweepResults& results) {
  const SweepPlan plan = plan_of();
  complete_tables(plan, results);
  return sweep_table(plan, results);
}

SweepRow timed(const std::string& id, SweepRole role, const std::vector<double>& times_s,
               std::optional<double> output_s) {
  SweepRow row = row_of(id, 1, 1, 30);
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
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {timed("fov", SweepRole::test, {1, 1}, 3),
                  timed("uniform", SweepRole::uniform_reference_rate, {8, 2}, 4)};
  const std::string text = table_of(results);
  EXPECT_NEAR(results.rows[0].speed_up.mean, 4, 1e-12);
  ASSERT_TRUE(results.rows[0].end_to_end.has_value());
  EXPECT_NEAR(*results.rows[0].end_to_end, std::sqrt(12.0 / 4 * 6 / 4), 1e-12);
  EXPECT_THAT(text, testing::ContainsRegex("\nid +role .* speed-up +end-to-end "));
  EXPECT_THAT(text, testing::ContainsRegex("\nfov +test .*  4 \\([^)]*\\) +2\\.121 "));
  EXPECT_THAT(text, HasSubstr("\nend-to-end: the same with exposure, view and writing of the pictures, without"));
}

TEST(SweepText, WithoutPicturesThereIsNoEndToEndRatio) {
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {timed("fov", SweepRole::test, {1}, 3),
                  timed("uniform", SweepRole::uniform_reference_rate, {8}, std::nullopt)};
  complete_tables(plan_of(), results);
  EXPECT_FALSE(results.rows[0].end_to_end.has_value());
  SweepPlan plan = plan_of();
  plan.measure.write_png = plan.measure.write_exr = false;
  EXPECT_THAT(sweep_table(plan, results), HasSubstr("\nend-to-end: not known, as no pictures were written\n"));
}

// "late" loses to "slow" in both; a wrong gaze is on no front. Less is better of mse, more of psnr: by psnr alone
// "even" is beaten by "fast", which is as good and faster.
TEST(SweepText, TellsTheFrontOfEachMetric) {
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {row_of("slow", 4, 1, 30), row_of("fast", 1, 4, 20), row_of("late", 5, 2, 25),
                  row_of("even", 2, 3, 20), row_of("wrong", 0.5, 0.5, 40)};
  results.rows.back().role = SweepRole::wrong_gaze;
  const std::string text = table_of(results);
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and mse: fast, even, slow\n"));
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and psnr: fast, slow\n"));
}

TEST(SweepText, TellsTheFrontOfEachReference) {
  SweepResults results;
  results.references = {reference_of("box-a"), reference_of("box-b")};
  results.rows = {row_of("small", 1, 1, 30), row_of("large", 2, 2, 20)};
  results.rows[1].reference = "box-b";
  const std::string text = table_of(results);
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and mse, reference box-a: small\n"));
  EXPECT_THAT(text, HasSubstr("\nPareto front of time and mse, reference box-b: large\n"));
}

}  // namespace
}  // namespace gazetrace
