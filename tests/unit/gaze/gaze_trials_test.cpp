// SPDX-License-Identifier: Apache-2.0
// Dividing a recording into trials, and cutting it to one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/gaze_trials.hpp"
#include "gazetrace/gaze_write.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::gaze_trials_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// 100 Hz, three blocks of 1 s with pauses of 1 s; in each, IMAGE ON at 100, 400 and 700 ms and IMAGE OFF 200 ms later.
GazeLog blocks_and_messages() {
  GazeLog log;
  log.source = "blocks.asc";
  for (std::int64_t block = 0; block < 3; ++block) {
    const std::int64_t begin_ns = 5'000 * kMs + block * 2'000 * kMs;
    for (std::int64_t i = 0; i < 100; ++i) {
      GazeSample sample;
      sample.t_ns = begin_ns + i * 10 * kMs;
      sample.row = block * 100 + i + 1;
      log.samples.push_back(sample);
    }
    for (std::int64_t k = 0; k < 3; ++k) {
      const std::int64_t on_ns = begin_ns + (100 + 300 * k) * kMs;
      log.events.push_back({GazeEventType::message, Eye::cyclopean, on_ns, on_ns, "IMAGE ON " + std::to_string(k), 0});
      log.events.push_back(
          {GazeEventType::message, Eye::cyclopean, on_ns + 200 * kMs, on_ns + 200 * kMs, "IMAGE OFF", 0});
    }
    log.events.push_back(
        {GazeEventType::segment, Eye::cyclopean, begin_ns, begin_ns + 990 * kMs, "recording block", 0});
  }
  return log;
}

// The trials that rules give, as an import names them.
std::vector<GazeTrial> trials_by(const TrialRules& rules, GazeLog log = blocks_and_messages()) {
  name_trials(log, rules);
  return find_trials(log);
}

std::string listing(const std::vector<GazeTrial>& trials) {
  std::string text;
  for (const GazeTrial& t : trials) {
    text += fmt::format("{}:{}-{}/{} ", t.number, t.begin_ns / kMs, t.end_ns / kMs, t.block);
  }
  return text;
}

TEST(GazeTrials, BlocksAreTrials) {
  EXPECT_EQ(listing(find_trials(blocks_and_messages())), "1:5000-5990/1 2:7000-7990/2 3:9000-9990/3 ");
}

TEST(GazeTrials, MessagesBeginAndEndTrials) {
  TrialRules settings;
  settings.begin = "IMAGE ON";
  // Up to the next one, but never beyond its block.
  EXPECT_EQ(listing(trials_by(settings)),
            "1:5100-5399/1 2:5400-5699/1 3:5700-5990/1 4:7100-7399/2 5:7400-7699/2 6:7700-7990/2 7:9100-9399/3 "
            "8:9400-9699/3 9:9700-9990/3 ");
  settings.end = "IMAGE OFF";
  settings.nth = 2;
  EXPECT_EQ(listing(trials_by(settings)), "1:5400-5600/1 ");
  settings.per_block = true;
  EXPECT_EQ(listing(trials_by(settings)), "1:5400-5600/1 2:7400-7600/2 3:9400-9600/3 ");
}

TEST(GazeTrials, PatternsFitTheWholeTextOrAPart) {
  EXPECT_TRUE(fits_pattern("TRIALID 12", "TRIALID"));
  EXPECT_TRUE(fits_pattern("TRIALID 12", "TRIALID *"));
  EXPECT_TRUE(fits_pattern("TRIALID 12", "*ID ??"));
  EXPECT_TRUE(fits_pattern("a.b.b.c", "a*b.c"));
  EXPECT_FALSE(fits_pattern("TRIALID 12", "TRIALID ?"));
  EXPECT_FALSE(fits_pattern("MY TRIALID 12", "TRIALID *"));
  EXPECT_FALSE(fits_pattern("", "?"));
  EXPECT_TRUE(fits_pattern("", "*"));
}

TEST(GazeTrials, ATableIsInSecondsOrNanoseconds) {
  const TemporaryFolder folder;
  TrialRules settings;
  settings.table = folder / "trials.tsv";
  std::ofstream(settings.table)
      << "onset\tduration\ttrial_type\n7.1\t0.25\tsecond\n5.000000001\t0.5\t\"first\"\n99\t1\tnone\n";
  const GazeLog log = blocks_and_messages();
  const std::vector<GazeTrial> trials = trials_by(settings, log);
  ASSERT_EQ(trials.size(), 2U);  // there is no sample in the last one
  EXPECT_EQ(trials[0].name, "first");
  EXPECT_EQ(trials[0].begin_ns, 5'000'000'001);
  EXPECT_EQ(trials[1].end_ns, 7'350 * kMs);
  EXPECT_EQ(trials[1].block, 2);
  EXPECT_EQ(trial_by_name(trials, "second").number, 2);
  EXPECT_EQ(trial_by_name(trials, "1").name, "first");
  EXPECT_THROW((void)trial_by_name(trials, "3"), Error);
  EXPECT_THROW((void)trial_by_name(trials, "third"), Error);
  std::ofstream(settings.table) << "onset,duration\n7.1,-1\n";
  try {
    trials_by(settings, log);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("trials.tsv:2: the trial ends before it begins"), std::string::npos)
        << error.what();
  }
}

TEST(GazeTrials, ACutLogHoldsTheTrialAlone) {
  GazeLog log = blocks_and_messages();
  log.calibrations.push_back({1'000 * kMs, Eye::left, 0.4, 0.8, 1});
  log.calibrations.push_back({8'500 * kMs, Eye::left, 0.9, 1.8, 2});
  const GazeLog cut = chosen_trial(log, "2");
  ASSERT_EQ(cut.samples.size(), 100U);
  EXPECT_EQ(cut.samples.front().row, 101);
  EXPECT_EQ(cut.calibrations.size(), 1U);  // the one that was made before it
  EXPECT_EQ(std::count_if(cut.events.begin(), cut.events.end(),
                          [](const GazeEvent& e) { return e.type == GazeEventType::message; }),
            6);
  ASSERT_TRUE(cut.trial);
  EXPECT_EQ(cut.trial->begin_ns, 7'000 * kMs);
  EXPECT_EQ(time_of_message(cut, "IMAGE ON#3"), 7'700 * kMs);
  EXPECT_EQ(time_of_message(cut, "IMAGE ON 1"), 7'400 * kMs);
  EXPECT_THROW((void)time_of_message(cut, "IMAGE ON#4"), Error);
  GazeLog counted = cut;
  count_from_first_sample(counted);
  EXPECT_EQ(counted.trial->begin_ns, 0);
}

// What names trials need not be there any more: they are in the file, as numbers only where nobody asked for names.
TEST(GazeTrials, NamedTrialsOutliveAnImport) {
  const TemporaryFolder folder;
  GazeLog log = blocks_and_messages();
  TrialRules rules;
  rules.begin = "IMAGE ON";
  name_trials(log, rules);
  name_trials(log, {});  // no rule takes nothing away
  const std::string named = listing(find_trials(log));
  EXPECT_EQ(find_trials(log).at(4).name, "IMAGE ON 1");
  GazeLog nameless = log;
  leave_out_identities(nameless);
  for (const bool keeps_names : {true, false}) {
    const GazeLog& written = keeps_names ? log : nameless;
    write_gaze_csv(written, folder / "log.csv");
    write_gaze_bids(written, folder / "sub-1_physio.tsv.gz");
    for (const char* const name : {"log.csv", "sub-1_recording-cyclopean_physio.tsv.gz"}) {
      const GazeLog back = load_gaze_log(folder / name, {});
      EXPECT_EQ(listing(find_trials(back)), named) << name;
      EXPECT_EQ(find_trials(back).at(4).name, keeps_names ? "IMAGE ON 1" : "") << name;
    }
  }
}

TEST(GazeTrials, RulesThatContradictEachOtherAreRefused) {
  const GazeLog log = blocks_and_messages();
  TrialRules settings;
  settings.table = "trials.tsv";
  settings.begin = "IMAGE ON";
  EXPECT_THROW(trials_by(settings, log), Error);
  settings = {};
  settings.nth = 2;
  EXPECT_THROW(trials_by(settings, log), Error);
  settings = {};
  settings.begin = "NO SUCH";
  try {
    trials_by(settings, log);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the log has 3 blocks and 18 messages"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace gazetrace::gaze_trials_test
