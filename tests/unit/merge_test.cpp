// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/output.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

class Merge : public testing::Test {
 protected:
  RunRecord part(const std::string& frames, const std::string& digest = "d1") {
    RunRecord record;
    record.version = "0.1.0";
    record.settings_digest = digest;
    record.frames = frames;
    record.is_part = true;
    record.input_digests = {{"scene.gltf", "s1"}};
    record.facts = {{"view", "ACES"}, {"load_s", frames}};
    record.warnings = {"same warning"};
    return record;
  }
  void write(const RunRecord& record, const std::vector<std::int32_t>& frames) {
    std::vector<TimingRow> rows;
    for (const std::int32_t frame : frames) {
      TimingRow row;
      row.frame = frame;
      row.trace_ms = frame;
      rows.push_back(row);
    }
    write_text_atomically(timing_file_name(folder_.path(), record.frames, true), timing_csv_text(rows));
    write_text_atomically(run_record_file_name(folder_.path(), record.frames, true), run_record_json(record));
  }
  void expect_error(const std::vector<std::string>& texts, bool overwrite = false) {
    try {
      merge_runs(folder_.path(), false, overwrite);
      FAIL() << texts.front();
    } catch (const Error& e) {
      for (const std::string& text : texts) {
        EXPECT_THAT(e.what(), testing::HasSubstr(text));
      }
    }
  }
  TemporaryFolder folder_;
};

TEST_F(Merge, JoinsInOrderOfFrames) {
  write(part("9-12"), {9, 10, 11, 12});
  write(part("1-8"), {1, 2, 3, 4, 5, 6, 7, 8});
  const MergeResult result = merge_runs(folder_.path(), false, false);
  EXPECT_EQ(result.parts.size(), 2U);
  EXPECT_EQ(result.frames, "1-12");
  EXPECT_TRUE(result.warnings.empty());
  const auto rows = read_timing_csv(folder_ / "timing.csv");
  ASSERT_EQ(rows.size(), 12U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].frame, static_cast<std::int32_t>(i + 1));
    EXPECT_EQ(rows[i].trace_ms, static_cast<double>(i + 1));
  }
  const RunRecord record = read_run_record(folder_ / "run.json");
  EXPECT_FALSE(record.is_part);
  EXPECT_EQ(record.frames, "1-12");
  EXPECT_EQ(record.settings_digest, "d1");
  EXPECT_THAT(record.facts,
              testing::UnorderedElementsAre(testing::Pair("view", "ACES"), testing::Pair("load_s of 1-8", "1-8"),
                                            testing::Pair("load_s of 9-12", "9-12")));
  EXPECT_THAT(record.warnings, testing::ElementsAre("same warning"));
}

TEST_F(Merge, InterleavedPartsHaveNoHoles) {
  write(part("1-9x2"), {1, 3, 5, 7, 9});
  write(part("2-8x2"), {2, 4, 6, 8});
  EXPECT_EQ(merge_runs(folder_.path(), false, false).frames, "1-9");
}

TEST_F(Merge, AResumedPartKeepsTheLastRowOfAFrame) {
  write(part("1-3"), {1, 2, 2, 3});
  merge_runs(folder_.path(), false, false);
  EXPECT_EQ(read_timing_csv(folder_ / "timing.csv").size(), 3U);
}

TEST_F(Merge, NothingIsOverwrittenUnlessAsked) {
  write(part("1-3"), {1, 2, 3});
  write_text_atomically(folder_ / "run.json", "precious");
  expect_error({"run.json", "exists already", "--overwrite"});
  EXPECT_EQ(file_bytes(folder_ / "run.json"), "precious");
  EXPECT_NO_THROW(merge_runs(folder_.path(), false, true));
  EXPECT_NE(file_bytes(folder_ / "run.json"), "precious");
}

TEST_F(Merge, HolesBetweenParts) {
  write(part("1-4"), {1, 2, 3, 4});
  write(part("7-9"), {7, 8, 9});
  expect_error({"frames are missing: 5-6", "--allow-missing"});
  const MergeResult result = merge_runs(folder_.path(), true, false);
  EXPECT_EQ(result.frames, "1-4,7-9");
  EXPECT_THAT(result.warnings, testing::ElementsAre("frames are missing: 5-6"));
}

TEST_F(Merge, APartThatWasKilled) {
  write(part("1-5"), {1, 2, 3});
  expect_error({"frames are missing: 4-5"});
}

TEST_F(Merge, OverlappingParts) {
  write(part("1-5"), {1, 2, 3, 4, 5});
  write(part("5-6"), {5, 6});
  expect_error({"frame 5 is in", "timing.1-5.csv as well"});
}

TEST_F(Merge, PartsOfDifferentJobs) {
  write(part("1-5"), {1, 2, 3, 4, 5});
  write(part("6-7", "d2"), {6, 7});
  expect_error({"timing.6-7.csv", "other settings than"});
}

TEST_F(Merge, PartsOfDifferentInputs) {
  write(part("1-5"), {1, 2, 3, 4, 5});
  RunRecord other = part("6-7");
  other.input_digests = {{"scene.gltf", "s2"}};
  write(other, {6, 7});
  expect_error({"timing.6-7.csv", "another version of scene.gltf"});
}

TEST_F(Merge, DifferentBuildsAreSaid) {
  write(part("1-5"), {1, 2, 3, 4, 5});
  RunRecord other = part("6-7");
  other.instruction_set = "avx2";
  write(other, {6, 7});
  EXPECT_THAT(merge_runs(folder_.path(), false, false).warnings,
              testing::ElementsAre(testing::HasSubstr("parts differ in instruction set")));
}

TEST_F(Merge, NothingToMerge) {
  expect_error({"holds no parts"});
  write(part("1-2"), {1, 2});
  std::filesystem::remove(folder_ / "run.1-2.json");
  expect_error({"timing.1-2.csv", "run.1-2.json is missing"});
  EXPECT_THROW(merge_runs(folder_ / "none", false, false), Error);
}

}  // namespace
}  // namespace gazetrace
