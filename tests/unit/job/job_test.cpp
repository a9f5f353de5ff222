// SPDX-License-Identifier: Apache-2.0
// A job as a value: who gave its options, what stands above what, and what it is as text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "gazetrace/job.hpp"
#include "gazetrace/resolve.hpp"
#include "job/defaults.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::job_test {
namespace {

using testing::HasSubstr;

constexpr const char* kCommandLine = "the command line";

void on_command_line(Job& job, const std::string& option, const std::string& value) {
  set_option(job, option, {value}, {Origin::given, kCommandLine, {}, {}});
}

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::vector<std::string> decisions_of(const Job& job) {
  std::vector<std::string> texts;
  for (const auto& [name, text] : job.decisions) {
    texts.push_back(text);
  }
  return texts;
}

TEST(Job, CopiesAreIndependent) {
  Job first;
  set_option(first, "spp", "4");
  Job second = first;
  set_option(second, "spp", "8");
  EXPECT_EQ(first.settings.foveation.spp, 4U);
  EXPECT_EQ(second.settings.foveation.spp, 8U);
  EXPECT_EQ(option_text(first, "spp"), "4");
}

TEST(Job, TextGivesTheSameJobBack) {
  Job job;
  set_option(job, "scene", "a \"b\" #c.gltf");
  set_option(job, "output", std::vector<std::string>{"f.####.exr", "f.####.png"});
  set_option(job, "gaze-start", "12345678901234567ns");
  set_option(job, "region-eccentricities", "2.5,7.25");
  set_option(job, "seed", "18446744073709551615");
  const std::string text = job_as_toml(job);
  const Job back = job_from_toml(text, "job.toml");
  EXPECT_EQ(job_as_toml(back), text);
  EXPECT_EQ(back.settings.outputs, job.settings.outputs);
  EXPECT_EQ(back.settings.trace.seed, 18446744073709551615U);
  EXPECT_EQ(back.sources.at("scene").origin, Origin::file);
}

TEST(Job, FilesThatCannotBeReadAndWrongValuesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { load_job(folder / "gone.toml"); }), HasSubstr("gone.toml: the settings file cannot be"));
  EXPECT_THAT(error_of([] { job_from_toml("\nspp = \"many\"\n", "job.toml"); }), HasSubstr("job.toml:2: spp: 'many'"));
  EXPECT_THAT(error_of([] { job_from_toml("ssp = 1\n", "job.toml"); }), HasSubstr("did you mean 'spp'"));
  Job job;
  EXPECT_THAT(error_of([&] { set_option(job, "spp", "many"); }), HasSubstr("`spp`: 'many' is not a number"));
  EXPECT_THAT(error_of([&] { set_option(job, "ssp", "1"); }), HasSubstr("did you mean 'spp'"));
  EXPECT_THAT(error_of([&] { set_option(job, "spp", std::vector<std::string>{"1", "2"}); }), HasSubstr("one value"));
  EXPECT_THAT(error_of([&] { set_option(job, "preset", "papre"); }), HasSubstr("did you mean 'paper'"));
}

TEST(Job, TheCommandLineIsAboveAFileInWhateverOrder) {
  Job first;
  on_command_line(first, "spp", "3");
  add_toml(first, "# one\nspp = 7\nbounces = 5\n", "job.toml");
  Job second;
  add_toml(second, "# one\nspp = 7\nbounces = 5\n", "job.toml");
  on_command_line(second, "spp", "3");
  EXPECT_EQ(job_as_toml(first), job_as_toml(second));
  EXPECT_EQ(first.settings.foveation.spp, 3U);
  EXPECT_EQ(first.settings.trace.max_bounces, 5);
  const std::vector<std::string> replaced{"the command line replaces spp = 7 of job.toml:2"};
  EXPECT_EQ(decisions_of(first), replaced);
  EXPECT_EQ(decisions_of(second), replaced);
}

// Every pair of neighbours in the order of precedence, set in both orders.
TEST(Job, OrderOfPrecedence) {
  // paper sets bounces = 3, reference sets spp = 1024, both set filter and accumulate.
  const auto file = [](Job& job) { add_toml(job, "preset = \"paper\"\nspp = 7\nfilter = \"linear\"\n", "job.toml"); };
  const auto preset = [](Job& job) { on_command_line(job, "preset", "reference"); };
  const auto option = [](Job& job) { on_command_line(job, "accumulate", "window"); };
  for (const bool reversed : {false, true}) {
    Job job;
    if (reversed) {
      option(job);
      preset(job);
      file(job);
    } else {
      file(job);
      preset(job);
      option(job);
    }
    const auto origin = [&](const char* name) { return job.sources.at(name).origin; };
    EXPECT_EQ(option_text(job, "accumulate"), "window");  // the command line above its preset
    EXPECT_EQ(origin("accumulate"), Origin::given);
    EXPECT_EQ(option_text(job, "spp"), "1024");  // the preset of the command line above the file
    EXPECT_EQ(origin("spp"), Origin::preset);
    EXPECT_EQ(option_text(job, "filter"), "none");
    EXPECT_EQ(option_text(job, "view"), "Reinhard");  // the file's preset above the default
    EXPECT_EQ(origin("view"), Origin::preset_of_file);
    EXPECT_FALSE(job.sources.contains("seed"));
    EXPECT_EQ(option_text(job, "preset"), "reference");
    EXPECT_THAT(decisions_of(job),
                testing::IsSupersetOf({"preset reference from the command line replaces spp = 7 of job.toml:2",
                                       "preset reference from the command line replaces filter = linear of job.toml:3",
                                       "the command line replaces preset = paper of job.toml:1"}));
  }
}

TEST(Job, WhatIsGivenTogetherSaysEachThingOnce) {
  const auto together = [](const std::vector<std::pair<std::string, std::string>>& options) {
    std::vector<GivenOption> given;
    for (const auto& [name, value] : options) {
      given.push_back({name, {value}, {}, {}});
    }
    return error_of([&] {
      Job job;
      set_options(job, given);
    });
  };
  EXPECT_EQ(together({{"sampling", "uniform"}, {"density", "mar"}}),
            "`sampling` uniform and `density`, which makes `sampling` density, contradict each other: which of them "
            "holds?");
  EXPECT_THAT(together({{"density", "mar"}, {"sampling", "regions"}}), HasSubstr("contradict each other"));
  EXPECT_THAT(together({{"spp", "3"}, {"budget-spp", "2"}}), HasSubstr("`budget-spp`, which makes `spp` 2,"));
  EXPECT_EQ(together({{"density", "mar"}, {"sampling", "density"}, {"spp", "2"}, {"spp", "3"}}), "");
  Job job;  // one after the other, the later holds
  set_option(job, "sampling", "uniform");
  set_option(job, "density", "mar");
  EXPECT_EQ(option_text(job, "sampling"), "density");
}

TEST(Job, AReplacedDensityIsNamedInItsDecision) {
  Job job;
  on_command_line(job, "density", "csf");
  add_toml(job, "density = \"mar\"\n", "job.toml");
  EXPECT_THAT(decisions_of(job), testing::ElementsAre("the command line replaces density = mar of job.toml:1"));
}

TEST(Job, AStatedQualityKeepsWhatIsSaidOfOtherSamplings) {
  Job job;
  set_option(job, "region-samples", "5,4,3");
  set_option(job, "target-relmse", "0.01");
  const Job chosen = with_default_sampling(job);
  EXPECT_EQ(option_text(chosen, "sampling"), "adaptive");
  EXPECT_EQ(option_text(chosen, "region-samples"), "5,4,3");
}

// A program may set what no option says.
TEST(Job, DifferentDensitiesOfAProgramHaveDifferentDigests) {
  JobSettings plain;
  DensitySampling density;
  plain.foveation.sampling = density;
  JobSettings sparse = plain;
  std::get<DensitySampling>(sparse.foveation.sampling).least_density = 0.5;
  JobSettings full = plain;
  std::get<DensitySampling>(full.foveation.sampling).full_rate_spp = 64;
  density.model.clear();
  density.curve.points = {{0, 1}, {20, 0.1}};
  JobSettings curve = plain;
  curve.foveation.sampling = density;
  JobSettings other = curve;
  std::get<DensitySampling>(other.foveation.sampling).curve.points[1].y = 0.2;
  std::set<std::string> digests;
  for (const JobSettings& settings : {plain, sparse, full, curve, other}) {
    digests.insert(digest_job(settings, {}));
  }
  EXPECT_EQ(digests.size(), 5U);
}

TEST(Job, AFolderWithTheNameOfAModelIsNoDensity) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "mar");
  Job job;
  add_toml(job, "density = \"mar\"\n", folder / "job.toml");
  EXPECT_EQ(option_text(job, "density"), "mar");
}

TEST(Job, AFileIsAboveItsPreset) {
  for (const char* text : {"preset = \"paper\"\nbounces = 5\n", "bounces = 5\npreset = \"paper\"\n"}) {
    const Job job = job_from_toml(text, "job.toml");
    EXPECT_EQ(job.settings.trace.max_bounces, 5);
    EXPECT_TRUE(job.is_given("bounces"));
    EXPECT_FALSE(job.is_given("region-samples"));
  }
}

// Decisions are written into records, and a place on the log's clock may be a time of day.
TEST(Job, WhatWasReplacedOfTheClockIsNamedWithoutItsValue) {
  Job job;
  add_toml(job, "gaze-start = \"1700000000s\"\n", "job.toml");
  on_command_line(job, "gaze-start", "1700000001s");
  EXPECT_THAT(decisions_of(job), testing::ElementsAre("the command line replaces gaze-start of job.toml:1"));
}

TEST(Job, AnInfiniteNumberIsInNoRange) {
  Job job;
  job.settings.trace.clamp_indirect = std::numeric_limits<double>::infinity();
  EXPECT_THROW(check_job(job), Error);
}

TEST(Job, EqualValuesReplaceNothing) {
  Job job;
  add_toml(job, "gaze-max-age = \"0.25s\"\n", "job.toml");
  on_command_line(job, "gaze-max-age", "250ms");
  EXPECT_TRUE(job.decisions.empty());
}

TEST(Job, OfARecordOrRefusedWithTheVersionThatWroteIt) {
  Job job;
  set_option(job, "spp", "4");
  RunRecord record;
  record.version = "0.0.9";
  record.config_toml = job_as_toml(job);
  EXPECT_EQ(job_as_toml(job_of_record(record, "run.json")), record.config_toml);
  record.config_toml += "option-of-long-ago = 3\n";
  const std::string error = error_of([&] { job_of_record(record, "run.json"); });
  EXPECT_THAT(error, HasSubstr("option-of-long-ago"));
  EXPECT_THAT(error, HasSubstr("gazetrace 0.0.9 wrote it"));
}

TEST(Job, RangesOfTheSchemaAreChecked) {
  const auto refused = [](const std::string& option, const std::string& value) {
    Job job;
    set_option(job, option, value);
    return error_of([&] { check_job(job); });
  };
  EXPECT_EQ(refused("bounces", "1001"), "`bounces`: 1001 is outside 0..1000");
  EXPECT_EQ(refused("threads", "-1"), "`threads`: -1 is outside 0..1024; 0 takes all");
  EXPECT_EQ(refused("exposure-key", "0"), "`exposure-key`: 0 is not above 0");
  EXPECT_EQ(refused("gaze-max-gap", "-5ms"), "`gaze-max-gap`: -5ms is not at least 0");
  EXPECT_EQ(refused("bounces", "1000"), "");
}

// Pixels in place of fractions would make all of the frame periphery. A place beside the screen is none of them.
TEST(Job, AFixedGazeIsNearTheScreen) {
  const auto error_at = [](const std::string& at) {
    Job job;
    set_option(job, "gaze-at", at);
    return error_of([&] { check_job(job, job_schema()); });
  };
  EXPECT_THAT(error_at("960,540"), HasSubstr("`gaze-at`: 960,540 lies far outside of the screen; give fractions of it "
                                             "from its top left, such as 0.5,0.5"));
  EXPECT_THAT(error_at("0.5,4.5"), HasSubstr("far outside"));
  EXPECT_THAT(error_at("-3.5,0.5"), HasSubstr("far outside"));
  for (const char* const near : {"0.5,0.5", "-0.2,1.3", "-2.9,3.9"}) {
    EXPECT_EQ(error_at(near), "") << near;
  }
}

TEST(JobSchema, EveryOptionSaysWhatItTouchesAndReadsItsDefaultBack) {
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    EXPECT_TRUE(option.touches.any()) << option.name;
    EXPECT_FALSE(option.help.empty()) << option.name;
    if (!option.defaults.empty()) {
      JobSettings settings;
      option.assign(settings, option.defaults, option.name);
      EXPECT_EQ(option.values(settings), option.defaults) << option.name;
    }
    if (option.is(Trait::needs_truth)) {
      EXPECT_TRUE(option.is(Trait::trade_off)) << option.name;
    }
  }
}

TEST(JobSchema, EveryDefaultIsInItsRange) {
  EXPECT_NO_THROW(check_job(Job{}));
}

TEST(JobSchema, WhatPresetsSetExists) {
  for (const Preset& preset : presets()) {
    Job job;
    EXPECT_NO_THROW(set_option(job, "preset", preset.name));
    for (const auto& [option, value] : preset.settings) {
      EXPECT_EQ(option_text(job, option), value) << preset.name;
    }
  }
}

TEST(IdleOptions, AreThoseThatWereGivenAndDoNothing) {
  Job job;
  set_option(job, "accumulate-past", "0.2s");
  EXPECT_TRUE(idle_option_warnings(job).empty()) << "a sequence may come";
  set_option(job, "accumulate", "off");
  EXPECT_EQ(idle_option_warnings(job), Warnings{"`accumulate-past` does nothing without `accumulate` window"});
  set_option(job, "accumulate", "window");
  EXPECT_TRUE(idle_option_warnings(job).empty());
  Job of_preset;
  set_option(of_preset, "preset", "paper");
  EXPECT_TRUE(idle_option_warnings(of_preset).empty());
}

}  // namespace
}  // namespace gazetrace::job_test
