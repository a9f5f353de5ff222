// SPDX-License-Identifier: Apache-2.0
// Which rows share a curve and a front, by rows whose crossings are known by hand.
#include "sweep/tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/sweep_row.hpp"

namespace gazetrace {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::UnorderedElementsAre;

SweepRow row_of(const std::string& id, SweepRole role, bool is_foveated, double time_s, double mse) {
  SweepRow row = row_of_box(id, time_s);
  row.role = role;
  row.is_foveated = is_foveated;
  row.runs.front().scores["mse"]["whole"] = mse;
  return row;
}

SweepPlan plan_of(double level) {
  SweepPlan plan;
  plan.measure.repeats = 1;
  plan.measure.comparison.metrics = {"mse"};
  plan.measure.fixed_quality = {{"mse", level}};
  return plan;
}

SweepReferenceResult reference_of(const std::string& key) {
  SweepReferenceResult reference;
  reference.key = key;
  reference.scene = "box";
  reference.floors.push_back({"left", {{"mse", {{"whole", 0.0}}}}, {}, {}});
  return reference;
}

SweepRow scaled(SweepRow row) {
  row.resolution_scale = 0.5;
  return row;
}

TEST(SweepTables, FixedQualityIsOfUniformAndFoveatedRowsAtFullSize) {
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {row_of("fov", SweepRole::test, true, 1, 1),
                  row_of("uniform-test", SweepRole::test, false, 2, 2),
                  scaled(row_of("small", SweepRole::test, true, 0.1, 0.1)),
                  scaled(row_of("small-uniform", SweepRole::test, false, 0.1, 0.1)),
                  row_of("rate1", SweepRole::uniform_rate, false, 1, 4),
                  row_of("rate4", SweepRole::uniform_rate, false, 4, 1)};
  complete_tables(plan_of(2), results);
  ASSERT_EQ(results.fixed_quality.size(), 1U);
  const FixedQuality& quality = results.fixed_quality.front().result;
  // Uniform reaches 2 in the 2 s of the uniform test; without that point it would be 4^(2/3) s. Foveated is better in
  // its only time, 1 s.
  ASSERT_TRUE(quality.speed_up.has_value());
  EXPECT_DOUBLE_EQ(*quality.speed_up, 2);
  EXPECT_EQ(quality.bound, ">");
}

SweepRow with(SweepRow row, const NamedValues& settings) {
  row.settings = settings;
  return row;
}

// All three curves fall from 4 to 1 while time grows fourfold: those that begin at 0.5 and 0.25 s are 2 and 4 times
// faster at every level between.
TEST(SweepTables, FixedQualityHasACurveForWhateverVariesBesideTheRate) {
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {row_of("rate1", SweepRole::uniform_rate, false, 1, 4),
                  row_of("rate4", SweepRole::uniform_rate, false, 4, 1)};
  for (const auto& [blocks, first_s] : {std::pair("1;1", 0.5), std::pair("2;4", 0.25)}) {
    for (const auto& [samples, time_s, mse] :
         {std::tuple("4;2;1", first_s, 4.0), std::tuple("16;8;4", 4 * first_s, 1.0)}) {
      results.rows.push_back(with(row_of(std::string(blocks) + samples, SweepRole::test, true, time_s, mse),
                                  {{"region-blocks", blocks}, {"region-samples", samples}}));
    }
  }
  complete_tables(plan_of(2), results);
  ASSERT_EQ(results.fixed_quality.size(), 2U);
  EXPECT_EQ(results.fixed_quality[0].curve, "region-blocks 1;1");
  EXPECT_NEAR(results.fixed_quality[0].result.speed_up.value_or(0), 2, 1e-12);
  EXPECT_EQ(results.fixed_quality[1].curve, "region-blocks 2;4");
  EXPECT_NEAR(results.fixed_quality[1].result.speed_up.value_or(0), 4, 1e-12);
}

TEST(SweepTables, FixedQualityTakesWhatVariesForTheCurveWhereNoRateDoes) {
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {row_of("rate1", SweepRole::uniform_rate, false, 1, 4),
                  row_of("rate4", SweepRole::uniform_rate, false, 4, 1),
                  with(row_of("coarse", SweepRole::test, true, 0.5, 4), {{"region-blocks", "2;4"}}),
                  with(row_of("fine", SweepRole::test, true, 2, 1), {{"region-blocks", "1;1"}})};
  complete_tables(plan_of(2), results);
  ASSERT_EQ(results.fixed_quality.size(), 1U);
  EXPECT_EQ(results.fixed_quality[0].curve, "");
  EXPECT_NEAR(results.fixed_quality[0].result.speed_up.value_or(0), 2, 1e-12);
}

TEST(SweepTables, UniformTestsAloneHaveNoSpeedUp) {
  SweepResults results;
  results.references = {reference_of("box-a")};
  results.rows = {row_of("uniform-test", SweepRole::test, false, 2, 2),
                  row_of("rate1", SweepRole::uniform_rate, false, 1, 4)};
  complete_tables(plan_of(3), results);
  EXPECT_TRUE(results.fixed_quality.empty());
}

TEST(SweepTables, RowsOfDifferentReferencesAreOnDifferentFronts) {
  SweepResults results;
  results.references = {reference_of("box-a"), reference_of("box-b")};
  results.rows = {row_of("small", SweepRole::test, true, 1, 1), row_of("large", SweepRole::test, true, 2, 2)};
  results.rows[1].reference = "box-b";
  complete_tables(plan_of(2), results);
  EXPECT_THAT(results.pareto.at("mse"), UnorderedElementsAre(Pair("box/left/box-a", ElementsAre("small")),
                                                             Pair("box/left/box-b", ElementsAre("large"))));
  results.rows[1].reference = "box-a";
  results.pareto.clear();
  complete_tables(plan_of(2), results);
  EXPECT_THAT(results.pareto.at("mse"), ElementsAre(Pair("box/left", ElementsAre("small"))));
}

}  // namespace
}  // namespace gazetrace
