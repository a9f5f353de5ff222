// SPDX-License-Identifier: Apache-2.0
// What the terminal is told, by rows whose fronts and ratios are known by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sweep/tables.hpp"

namespace gazetrace {
namespace {

using testing::HasSubstr;
using testing::Not;

SweepRow row_of(const std::string& id, double time_s, double mse, double psnr) {
  SweepRow row;
  row.id = id;
  row.scene = "box";
  row.gaze = "left";
  row.curve = "one";
  row.reference = "box-a";
  row.is_foveated = true;
  row.compared_pixels = 10;
  row.runs.resize(1);
  row.runs.front().time_s = time_s;
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
