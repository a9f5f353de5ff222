// SPDX-License-Identifier: Apache-2.0
// What rows of a sweep share with their references follows from what options touch, and from no words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/sweep_plan.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::sweep_plan_test {
namespace {

// Rows that vary one option of every kind.
constexpr const char* kPlan = R"(
[common]
size = "32x18"
frames = 1
eye = [0, 0, 3]
target = [0, 0, 0]
screen-px = [32, 18]
screen-cm = [32, 18]
screen-distance-cm = 60
preset = "paper"
env = "constant:1,1,1"

[[scene]]
name = "triangle"
path = "{}"

[[gaze]]
name = "middle"
at = [0.5, 0.5]

[[setting]]
label = "plain"
[[setting]]
label = "sampling"
region-samples = [8, 4, 2]
[[setting]]
label = "filter"
filter = "none"
[[setting]]
label = "window"
accumulate = "window"
[[setting]]
label = "trade-off"
clamp-indirect = 4
[[setting]]
label = "colour"
exposure-key = 0.3
[[setting]]
label = "lens"
aperture = 0.01
focus-distance = 3
[[setting]]
label = "gaze"
gaze-latency = "20ms"

[reference]
spp = 2

[measure]
metrics = "mse"
)";

class SweepPlanFile : public testing::Test {
 protected:
  SweepPlanFile() {
    std::string text = kPlan;
    text.replace(text.find("{}"), 2, GAZETRACE_SOURCE_DIR "/tests/data/package/triangle.gltf");
    write_text_atomically(path_, text);
  }
  static std::map<std::string, std::vector<std::string>> sharing(const SweepPlan& plan) {
    std::map<std::string, std::vector<std::string>> rows;
    for (const SweepTest& test : plan.tests) {
      rows[test.label] = {test.digest, test.uniform_digest, test.reference};
      for (const auto& [option, value] : test.uniform_settings) {
        rows[test.label].push_back(option + "=" + value);
      }
    }
    return rows;
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "plan.toml";
};

TEST_F(SweepPlanFile, HelpHeadingsDecideNothing) {
  const SweepPlan plan = load_sweep_plan(path_).plan;
  ASSERT_EQ(plan.tests.size(), 8U);
  for (const auto& heading : std::vector<std::function<std::string(const Option&)>>{
           [](const Option&) { return "Everything"; }, [](const Option& option) { return "About " + option.name; },
           [](const Option& option) { return option.touches.has(Touch::sampling) ? "Gaze log" : "Density models"; }}) {
    const SweepPlan reworded = load_sweep_plan(path_, {}, {}, job_schema().with_headings(heading)).plan;
    EXPECT_EQ(sharing(reworded), sharing(plan));
    EXPECT_EQ(reworded.common_settings, plan.common_settings);
    EXPECT_EQ(reworded.stated_settings, plan.stated_settings);
    ASSERT_EQ(reworded.references.size(), plan.references.size());
    for (std::size_t i = 0; i < plan.references.size(); ++i) {
      EXPECT_EQ(reworded.references[i].digest, plan.references[i].digest);
    }
  }
}

TEST_F(SweepPlanFile, RowsShareTheirReferenceUnlessTheyPictureSomethingElse) {
  const auto rows = sharing(load_sweep_plan(path_).plan);
  const auto reference = [&](const char* label) { return rows.at(label)[2]; };
  for (const char* label : {"sampling", "filter", "window", "trade-off", "gaze"}) {
    EXPECT_EQ(reference(label), reference("plain")) << label;
  }
  EXPECT_NE(reference("colour"), reference("plain"));
  EXPECT_NE(reference("lens"), reference("plain"));
  EXPECT_NE(reference("lens"), reference("colour"));
}

TEST_F(SweepPlanFile, UniformFramesAreSharedByWhatTheySee) {
  const auto rows = sharing(load_sweep_plan(path_).plan);
  const auto uniform = [&](const char* label) { return rows.at(label)[1]; };
  EXPECT_EQ(uniform("sampling"), uniform("plain"));
  EXPECT_EQ(uniform("gaze"), uniform("plain"));
  for (const char* label : {"filter", "window", "trade-off", "colour", "lens"}) {
    EXPECT_NE(uniform(label), uniform("plain")) << label;
  }
}

// The other way round: what an option is said to touch does decide.
TEST_F(SweepPlanFile, WhatOptionsTouchDecides) {
  const auto rows = sharing(load_sweep_plan(path_).plan);
  JobSchema schema;
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    OptionOf<JobSettings> changed = option;
    if (option.name == "exposure-key") {
      changed.touches = Touch::sampling;
    }
    schema.add(std::move(changed));
  }
  const auto other = sharing(load_sweep_plan(path_, {}, {}, schema).plan);
  EXPECT_NE(rows.at("colour")[2], rows.at("plain")[2]);
  EXPECT_EQ(other.at("colour")[2], other.at("plain")[2]);
}

TEST_F(SweepPlanFile, AGridOfMoreCombinationsThanAnybodyRendersIsRefused) {
  std::string values = "[1";
  for (int value = 2; value <= 20; ++value) {
    values += ", " + std::to_string(value);
  }
  std::string text = file_bytes(path_) + "\n[grid]\n";
  for (const char* option : {"spp", "seed", "bounces", "block-samples", "exposure-key"}) {
    text += std::string(option) + " = " + values + "]\n";
  }
  write_text_atomically(path_, text);
  try {
    (void)load_sweep_plan(path_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("[grid] has more than 100000 combinations"));
  }
}

}  // namespace
}  // namespace gazetrace::sweep_plan_test
