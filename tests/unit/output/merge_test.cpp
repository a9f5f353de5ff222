// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <span>

#include "core/file_digest.hpp"
#include "gazetrace/output.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::merge_test {
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
    write_text_atomically(timing_file_name(run_name_, record.frames, true), timing_csv_text(rows));
    write_text_atomically(run_record_file_name(run_name_, record.frames, true), run_record_json(record));
  }
  // These parts have no pictures.
  static MergeOptions options(bool allow_missing = false, bool overwrite = false) {
    MergeOptions options;
    options.allow_missing = allow_missing;
    options.overwrite = overwrite;
    options.trust_files = true;
    return options;
  }
  void expect_error(const std::vector<std::string>& texts, bool overwrite = false) {
    try {
      merge_runs(folder_.path(), options(false, overwrite));
      FAIL() << texts.front();
    } catch (const Error& e) {
      for (const std::string& text : texts) {
        EXPECT_THAT(e.what(), testing::HasSubstr(text));
      }
    }
  }
  TemporaryFolder folder_;
  std::string run_name_ = folder_.path() + "/";  // of the version before, whose parts have the name of no sequence
};

TEST_F(Merge, OneSequenceOfSeveralInAFolder) {
  for (const char* name : {"f", "g"}) {
    run_name_ = folder_ / name;
    write(part("1-2"), {1, 2});
    write(part("3-4"), {3, 4});
  }
  expect_error({"g.timing.1-2.csv: is of another sequence than", "f.timing.1-2.csv", "as out/frame.####.exr"});
  EXPECT_EQ(merge_runs(folder_ / "g.####.exr", options()).frames, "1-4");
  EXPECT_EQ(read_run_record(folder_ / "g.run.json").frames, "1-4");
  EXPECT_EQ(read_timing_csv(folder_ / "g.timing.csv").size(), 4U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "f.run.json"));
}

TEST_F(Merge, JoinsInOrderOfFrames) {
  write(part("9-12"), {9, 10, 11, 12});
  write(part("1-8"), {1, 2, 3, 4, 5, 6, 7, 8});
  const MergeResult result = merge_runs(folder_.path(), options());
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
  EXPECT_EQ(merge_runs(folder_.path(), options()).frames, "1-9");
}

TEST_F(Merge, AResumedPartKeepsTheLastRowOfAFrame) {
  write(part("1-3"), {1, 2, 2, 3});
  merge_runs(folder_.path(), options());
  EXPECT_EQ(read_timing_csv(folder_ / "timing.csv").size(), 3U);
}

TEST_F(Merge, NothingIsOverwrittenUnlessAsked) {
  write(part("1-3"), {1, 2, 3});
  write_text_atomically(folder_ / "run.json", "precious");
  expect_error({"run.json", "exists already", "`overwrite`"});
  EXPECT_EQ(file_bytes(folder_ / "run.json"), "precious");
  EXPECT_NO_THROW(merge_runs(folder_.path(), options(false, true)));
  EXPECT_NE(file_bytes(folder_ / "run.json"), "precious");
}

TEST_F(Merge, HolesBetweenParts) {
  write(part("1-4"), {1, 2, 3, 4});
  write(part("7-9"), {7, 8, 9});
  expect_error({"frames are missing: 5-6", "`allow-missing`"});
  const MergeResult result = merge_runs(folder_.path(), options(true));
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
  EXPECT_THAT(merge_runs(folder_.path(), options()).warnings,
              testing::ElementsAre(testing::HasSubstr("parts differ in instruction set")));
}

TEST_F(Merge, PartsOfDifferentDenoisersAreRefused) {
  RunRecord one = part("1-5");
  one.denoiser = "Open Image Denoise 2.5.1, quality high, built-in weights, avx2";
  write(one, {1, 2, 3, 4, 5});
  RunRecord other = part("6-7");
  other.denoiser = "Open Image Denoise 2.3.3, quality high, built-in weights, avx2";
  write(other, {6, 7});
  expect_error({"2.3.3", "2.5.1", "one library"});
}

// A part with a file for each of its frames.
class MergeFiles : public Merge {
 protected:
  void SetUp() override {
    for (const std::string frames : {"1-2", "3-4"}) {
      RunRecord record = part(frames);
      for (const std::int32_t frame : parse_frame_list(frames)) {
        const std::string name = "f." + std::to_string(frame) + ".png";
        write_text_atomically(folder_ / name, "picture " + name);
        record.files[name] = {frame, 15, digests_.at(static_cast<std::size_t>(frame - 1))};
      }
      write(record, parse_frame_list(frames));
    }
  }
  std::vector<std::string> problems() {
    std::vector<std::string> texts;
    for (const BadFile& file : find_bad_files(read_run_parts(folder_.path()))) {
      texts.push_back(std::to_string(file.frame) + " " + file.problem);
    }
    return texts;
  }
  // Of "picture f.1.png" and so on, by digest_bytes().
  const std::vector<std::string> digests_{digest("picture f.1.png"), digest("picture f.2.png"),
                                          digest("picture f.3.png"), digest("picture f.4.png")};

 private:
  static std::string digest(const std::string& text) { return digest_bytes(std::as_bytes(std::span(text))); }
};

TEST_F(MergeFiles, GoodFilesAreJoinedWithTheirDigests) {
  EXPECT_THAT(problems(), testing::IsEmpty());
  merge_runs(folder_.path());
  EXPECT_EQ(read_run_record(folder_ / "run.json").files.size(), 4U);
}

TEST_F(MergeFiles, BadFilesAreFoundAndNothingIsJoined) {
  std::filesystem::remove(folder_ / "f.1.png");
  write_text_atomically(folder_ / "f.2.png", "picture f.3.png");
  write_text_atomically(folder_ / "f.4.png", "pict");
  EXPECT_THAT(problems(), testing::ElementsAre("1 is missing", "2 has another content than was written",
                                               "4 has 4 bytes in place of 15"));
  try {
    merge_runs(folder_.path());
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("3 files are"), testing::HasSubstr("frames 1-2,4"),
                               testing::HasSubstr("f.2.png: has another content"), testing::HasSubstr("`resume`")));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.json"));
  MergeOptions some;
  some.allow_missing = true;
  const MergeResult result = merge_runs(folder_.path(), some);
  EXPECT_EQ(result.frames, "3");
  EXPECT_EQ(result.warnings.size(), 4U);
  EXPECT_EQ(read_run_record(folder_ / "run.json").files.size(), 1U);
}

TEST_F(MergeFiles, AFrameWithoutFilesIsBad) {
  write(part("5-6"), {5, 6});
  EXPECT_THAT(problems(), testing::ElementsAre("5 lists no file of frame 5", "6 lists no file of frame 6"));
}

TEST_F(MergeFiles, TheJournalOfAKilledPartCounts) {
  RunRecord killed = part("5-6");
  write(killed, {5});
  write_text_atomically(folder_ / "f.5.png", "picture f.1.png");
  const std::string journal = file_journal_name(run_record_file_name(run_name_, "5-6", true));
  write_text_atomically(journal, "5 15 " + digests_[0] + " f.5.png\n6 15 0123");
  EXPECT_THAT(problems(), testing::IsEmpty());
  EXPECT_EQ(read_file_journal(journal), (WrittenFiles{{"f.5.png", {5, 15, digests_[0]}}}));
}

TEST_F(Merge, NothingToMerge) {
  expect_error({"contains no parts"});
  write(part("1-2"), {1, 2});
  std::filesystem::remove(folder_ / "run.1-2.json");
  expect_error({"timing.1-2.csv", "run.1-2.json is missing"});
  EXPECT_THROW(merge_runs(folder_ / "none", options()), Error);
}

}  // namespace
}  // namespace gazetrace::merge_test
