// SPDX-License-Identifier: Apache-2.0
// Old names of options: what the table says fits the options that there are, and what is renamed is understood wherever
// options are read.
#include "gazetrace/former_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "gazetrace/job.hpp"

namespace gazetrace::former_options_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

std::vector<FormerOption> two_modes() {
  return {former_option(FormerKind::renamed, "--mode fast", "--spp 2 --bounces 1", "it says more"),
          former_option(FormerKind::gone, "--mode slow", "", "give a higher `spp`"),
          former_option(FormerKind::renamed, "--mode *", "--spp *", "one number is enough"),
          former_option(FormerKind::renamed, "--quick", "--russian-roulette", "the field calls it so"),
          former_option(FormerKind::renamed, "--fast", "--spp 2", "it says more"),
          former_option(FormerKind::renamed, "--diameters *", "--radii */2", "they count from the middle"),
          former_option(FormerKind::renamed, "--shape round", "", "all are round"),
          former_option(FormerKind::elsewhere, "--rays", "", "the number of samples a pixel is `spp`")};
}

CurrentOptions now(const std::string& option, const std::string& value) {
  return current_options({option, {value}}, {{option, {value}}}, ErrorKind::usage, "here", two_modes());
}

std::string refusal(const std::string& option, const std::string& value) {
  try {
    (void)now(option, value);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(FormerOptions, ARenamedOptionBecomesTheOnesThatTookItsPlace) {
  EXPECT_THAT(now("mode", "7").settings, ElementsAre(Pair("spp", ElementsAre("7"))));
  EXPECT_THAT(now("mode", "fast").settings,
              ElementsAre(Pair("spp", ElementsAre("2")), Pair("bounces", ElementsAre("1"))));
  EXPECT_THAT(now("quick", "false").settings, ElementsAre(Pair("russian-roulette", ElementsAre("false"))));
  EXPECT_EQ(now("mode", "fast").notice, "`mode` fast is now `spp` 2 `bounces` 1; it says more");
  EXPECT_EQ(now("quick", "true").notice, "`quick` is now `russian-roulette`; the field calls it so");
}

TEST(FormerOptions, AFlagThatWasNotSetSetsNothing) {
  EXPECT_THAT(now("fast", "true").settings, ElementsAre(Pair("spp", ElementsAre("2"))));
  EXPECT_TRUE(now("fast", "false").settings.empty());
  EXPECT_EQ(now("fast", "false").notice, "");
}

TEST(FormerOptions, AnOptionMayStandForHalfOfTheNumbersOrForNothing) {
  EXPECT_THAT(now("diameters", "5.2,17").settings, ElementsAre(Pair("radii", ElementsAre("2.6,8.5"))));
  EXPECT_EQ(now("diameters", "5.2,17").notice, "`diameters` is now `radii` 2.6,8.5; they count from the middle");
  EXPECT_THAT(now("shape", "round").settings, ElementsAre());
  EXPECT_EQ(now("shape", "round").notice, "`shape` round is no longer said; all are round");
}

TEST(FormerOptions, PartsForWhichThereIsNoPlaceAreNotDropped) {
  const std::vector<FormerOption> table{
      former_option(FormerKind::renamed, "--ends *", "--curve line:from=*,to=*", "it is said with it")};
  const auto curve_of = [&](const std::string& value) {
    const OptionText given{"ends", {value}};
    return current_options(given, {given}, ErrorKind::usage, "here", table).settings;
  };
  EXPECT_THAT(curve_of("1,2"), ElementsAre(Pair("curve", ElementsAre("line:from=1,to=2"))));
  EXPECT_THAT(curve_of("1,2,3"), ElementsAre(Pair("curve", ElementsAre("line:from=1,to=2,3"))));
}

TEST(FormerOptions, WhatNoRowSpeaksOfStaysAsItIs) {
  EXPECT_THAT(now("size", "64x36").settings, ElementsAre(Pair("size", ElementsAre("64x36"))));
  EXPECT_EQ(now("size", "64x36").notice, "");
}

TEST(FormerOptions, WhatIsGoneIsRefusedWithWhatToUseInstead) {
  EXPECT_EQ(refusal("mode", "slow"), "here: 'slow' is gone; give a higher `spp`");
  EXPECT_EQ(refusal("rays", "5"), "here: there is no such option; the number of samples a pixel is `spp`");
}

TEST(FormerOptions, ARowMayAskForAnotherOptionBesideIt) {
  const std::vector<FormerOption> table{
      former_option(FormerKind::renamed, "--model *", "--curve *", "it is one"),
      former_option(FormerKind::renamed, "--slope * --model line|arc", "--curve :slope=*", "it is said with it"),
      former_option(FormerKind::renamed, "--slope * --model *", "", "this one has none"),
      former_option(FormerKind::gone, "--slope", "", "give it with its `curve`"),
      former_option(FormerKind::renamed, "--ends * --model line", "--curve :from=*,to=*", "it is said with it")};
  const auto settings_of = [&](const std::vector<OptionText>& given) {
    std::vector<OptionText> settings;
    for (const OptionText& one : given) {
      for (const OptionText& now : current_options(one, given, ErrorKind::usage, "here", table).settings) {
        settings.push_back(now);
      }
    }
    return settings;
  };
  const OptionText slope{"slope", {"0.5"}};
  const OptionText ends{"ends", {"2,8"}};
  EXPECT_THAT(settings_of({slope, {"model", {"arc"}}}), ElementsAre(Pair("curve", ElementsAre("arc:slope=0.5"))));
  EXPECT_THAT(settings_of({{"model", {"line"}}, ends, slope}),
              ElementsAre(Pair("curve", ElementsAre("line:from=2,to=8,slope=0.5"))));
  EXPECT_THAT(settings_of({{"model", {"box"}}, slope}), ElementsAre(Pair("curve", ElementsAre("box"))));
  EXPECT_THROW(settings_of({slope}), Error);
}

// Each row of the table of this version, held against the options of this version.
TEST(FormerOptions, TheTableFitsTheOptions) {
  std::set<std::string> rows;
  for (const FormerOption& former : former_options()) {
    const std::string row = former.option + " " + former.value;
    SCOPED_TRACE(row);
    EXPECT_TRUE(rows.insert(row + " " + former.beside + " " + former.beside_values).second) << "there are two rows";
    EXPECT_FALSE(former.reason.empty());
    EXPECT_FALSE(former.reason.ends_with('.'));
    EXPECT_TRUE(!former.value.empty() || job_schema().find(former.option) == nullptr) << "it is an option still";
    EXPECT_TRUE(former.kind == FormerKind::renamed || former.replacements.empty());
    for (const auto& [name, value] : former.replacements) {
      const OptionOf<JobSettings>* option = job_schema().find(name);
      ASSERT_NE(option, nullptr) << "there is no option " << name;
      if (!value.empty() && value.find('*') == std::string::npos && !value.starts_with(':')) {
        EXPECT_NO_THROW(option->check({value}, name)) << value;
      }
    }
  }
}

TEST(FormerOptions, AJobAndItsFileAreToldOfThem) {
  const auto error_of = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(error_of([] {
                Job job;
                set_option(job, "samples", "5");
              }),
              HasSubstr("`samples`: there is no such option; the number of samples a pixel is `spp`"));
  EXPECT_THAT(error_of([] { job_from_toml("\nsamples = 5\n", "job.toml"); }),
              HasSubstr("job.toml:2: samples: there is no such option; the number of samples a pixel is `spp`"));
}

// Records state every option of the version that wrote them.
TEST(FormerOptions, TheRecordOfAnEarlierVersionIsUnderstood) {
  RunRecord record;
  record.config_toml =
      "angle-reading = \"eccentricity\"\nbudget-spp = 2\nfalloff = \"mar\"\nfalloff-eye = \"both\"\n"
      "falloff-mar-slope = 0.03\nfalloff-ramp = [5, 25, 0.1]\nregion-angles = [4, 10]\nregion-shape = \"cone\"\n"
      "sample-unit = \"pixel\"\nspp = 32\n";
  const Job job = job_of_record(record, "run.json");
  EXPECT_EQ(option_text(job, "sampling"), "density");
  EXPECT_EQ(option_text(job, "density"), "mar:slope=0.03");
  EXPECT_EQ(option_text(job, "region-eccentricities"), "4,10");
  EXPECT_EQ(option_text(job, "spp"), "2");
}

TEST(FormerOptions, TheRecordOfAFinishedRunNeedsNoFilesThatAreGone) {
  RunRecord record;
  record.config_toml = "spp = 4\ndensity = \"gone.csv\"\n";
  EXPECT_EQ(option_text(job_of_record(record, "run.json"), "spp"), "4");
}

}  // namespace
}  // namespace gazetrace::former_options_test
