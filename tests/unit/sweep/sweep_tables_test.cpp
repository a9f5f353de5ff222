// SPDX-License-Identifier: Apache-2.0
// Which rows share a curve and a front, by rows whose crossings are known by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/sweep_row.hpp"
#include "sweep/conclude.hpp"

namespace gazetrace::sweep_tables_test {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::UnorderedElementsAre;

MeasuredRow row_of(const std::string& id, RowRole role, bool is_foveated, double time_s, double mse) {
  MeasuredRow row = row_of_box(id, time_s);
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

ResultReference reference_of(const std::string& key) {
  ResultReference reference;
  reference.key = key;
  reference.scene = "box";
  reference.floors.push_back({"left", {{"mse", {{"whole", 0.0}}}}, {}, {}});
  return reference;
}

MeasuredRow scaled(MeasuredRow row) {
  row.resolution_scale = 0.5;
  return row;
}

TEST(SweepTables, FixedQualityIsOfUniformAndFoveatedRowsAtFullSize) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {row_of("fov", RowRole::test, true, 1, 1),
                   row_of("uniform-test", RowRole::test, false, 2, 2),
                   scaled(row_of("small", RowRole::test, true, 0.1, 0.1)),
                   scaled(row_of("small-uniform", RowRole::test, false, 0.1, 0.1)),
                   row_of("rate1", RowRole::uniform_rate, false, 1, 4),
                   row_of("rate4", RowRole::uniform_rate, false, 4, 1)};
  const Results results = conclude({}, plan_of(2), measured);
  ASSERT_EQ(results.fixed_quality.size(), 1U);
  const FixedQuality& quality = results.fixed_quality.front().result;
  // Uniform reaches 2 in the 2 s of the uniform test; without that point it would be 4^(2/3) s. Foveated is better in
  // its only time, 1 s.
  ASSERT_TRUE(quality.speed_up.has_value());
  EXPECT_DOUBLE_EQ(*quality.speed_up, 2);
  EXPECT_EQ(quality.bound, ">");
}

MeasuredRow with(MeasuredRow row, const NamedValues& settings) {
  row.settings = settings;
  return row;
}

// All three curves fall from 4 to 1 while time grows fourfold: those that begin at 0.5 and 0.25 s are 2 and 4 times
// faster at every level between.
TEST(SweepTables, FixedQualityHasACurveForWhateverVariesBesideTheRate) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {row_of("rate1", RowRole::uniform_rate, false, 1, 4),
                   row_of("rate4", RowRole::uniform_rate, false, 4, 1)};
  for (const auto& [blocks, first_s] : {std::pair("1;1", 0.5), std::pair("2;4", 0.25)}) {
    for (const auto& [samples, time_s, mse] :
         {std::tuple("4;2;1", first_s, 4.0), std::tuple("16;8;4", 4 * first_s, 1.0)}) {
      measured.rows.push_back(with(row_of(std::string(blocks) + samples, RowRole::test, true, time_s, mse),
                                   {{"region-blocks", blocks}, {"region-samples", samples}}));
    }
  }
  const Results results = conclude({}, plan_of(2), measured);
  ASSERT_EQ(results.fixed_quality.size(), 2U);
  EXPECT_EQ(results.fixed_quality[0].curve, "region-blocks 1;1");
  EXPECT_NEAR(results.fixed_quality[0].result.speed_up.value_or(0), 2, 1e-12);
  EXPECT_EQ(results.fixed_quality[1].curve, "region-blocks 2;4");
  EXPECT_NEAR(results.fixed_quality[1].result.speed_up.value_or(0), 4, 1e-12);
}

TEST(SweepTables, FixedQualityTakesWhatVariesForTheCurveWhereNoRateDoes) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {row_of("rate1", RowRole::uniform_rate, false, 1, 4),
                   row_of("rate4", RowRole::uniform_rate, false, 4, 1),
                   with(row_of("coarse", RowRole::test, true, 0.5, 4), {{"region-blocks", "2;4"}}),
                   with(row_of("fine", RowRole::test, true, 2, 1), {{"region-blocks", "1;1"}})};
  const Results results = conclude({}, plan_of(2), measured);
  ASSERT_EQ(results.fixed_quality.size(), 1U);
  EXPECT_EQ(results.fixed_quality[0].curve, "");
  EXPECT_NEAR(results.fixed_quality[0].result.speed_up.value_or(0), 2, 1e-12);
}

TEST(SweepTables, UniformTestsAloneHaveNoSpeedUp) {
  Measurements measured;
  measured.references = {reference_of("box-a")};
  measured.rows = {row_of("uniform-test", RowRole::test, false, 2, 2),
                   row_of("rate1", RowRole::uniform_rate, false, 1, 4)};
  const Results results = conclude({}, plan_of(3), measured);
  EXPECT_TRUE(results.fixed_quality.empty());
}

TEST(SweepTables, RowsOfDifferentReferencesAreOnDifferentFronts) {
  Measurements measured;
  measured.references = {reference_of("box-a"), reference_of("box-b")};
  measured.rows = {row_of("small", RowRole::test, true, 1, 1), row_of("large", RowRole::test, true, 2, 2)};
  measured.rows[1].reference = "box-b";
  const Results results = conclude({}, plan_of(2), measured);
  EXPECT_THAT(results.pareto.at("mse"), UnorderedElementsAre(Pair("box/left/box-a", ElementsAre("small")),
                                                             Pair("box/left/box-b", ElementsAre("large"))));
  measured.rows[1].reference = "box-a";
  const Results together = conclude({}, plan_of(2), measured);
  EXPECT_THAT(together.pareto.at("mse"), ElementsAre(Pair("box/left", ElementsAre("small"))));
}

}  // namespace
}  // namespace gazetrace::sweep_tables_test
