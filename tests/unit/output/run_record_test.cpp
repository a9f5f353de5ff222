// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "gazetrace/output.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::run_record_test {
namespace {

TEST(RunRecord, RoundTrip) {
  RunRecord record;
  record.version = "0.1.0";
  record.build = "gcc \"12\"";
  record.instruction_set = "avx512";
  record.ray_library = "Embree";
  record.denoiser = "Open Image Denoise 2.5.1";
  record.command_line = {"gazetrace", "render", "a b.gltf", "--key=\\\n"};
  record.config_toml = "a = 1\n# comment\n";
  record.settings_digest = "00ff";
  record.part_digests = {"01", "02"};
  record.input_digests = {{"a.gltf", "12"}, {"ä.csv", "34"}};
  record.frames = "1-100x2";
  record.is_part = true;
  record.facts = {{"load_s", "1.5"}};
  record.warnings = {"one", "two"};
  record.bad_samples = {{3, 4, 5, 6, "rejected ray"}};
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  write_text_atomically(path, run_record_json(record));
  EXPECT_EQ(run_record_json(read_run_record(path)), run_record_json(record));
  EXPECT_EQ(read_run_record(path).denoiser, record.denoiser);
  EXPECT_EQ(read_run_record(path).part_digests, record.part_digests);
  const auto json = nlohmann::json::parse(file_bytes(path));
  EXPECT_EQ(json["command_line"][3], "--key=\\\n");
  EXPECT_EQ(json["input_digests"]["a.gltf"], "12");
  EXPECT_EQ(json["bad_samples"][0]["sample"], 6);
  EXPECT_EQ(json["is_part"], true);
}

TEST(RunRecord, PathsThatAreNoUtf8DoNotEndTheRun) {
  RunRecord record;
  record.command_line = {"\xff.gltf"};
  EXPECT_NO_THROW(run_record_json(record));
}

TEST(RunRecord, BrokenRecords) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  for (const char* text : {"", "{", "[]", "{\"version\": 1}"}) {
    write_text_atomically(path, text);
    try {
      read_run_record(path);
      FAIL() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      EXPECT_THAT(e.what(), testing::HasSubstr("run.json: is not a run record"));
    }
  }
}

TEST(RunRecord, NumbersThatCannotStandThereAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  RunRecord record;
  record.frames = "1";
  record.bad_samples = {{1, 2, 3, 4, "rejected ray"}};
  record.files = {{"f.exr", {1, 10, "00"}}};
  const auto whole = nlohmann::json::parse(run_record_json(record));
  for (const nlohmann::json& number :
       {nlohmann::json(1e300), nlohmann::json(1.5), nlohmann::json(-1e300), nlohmann::json(5'000'000'000)}) {
    for (const char* key : {"/files/f.exr/frame", "/bad_samples/0/frame", "/bad_samples/0/sample"}) {
      auto changed = whole;
      changed[nlohmann::json::json_pointer(key)] = number;
      write_text_atomically(path, changed.dump());
      try {
        read_run_record(path);
        ADD_FAILURE() << key << " " << number;
      } catch (const Error& e) {
        EXPECT_THAT(e.what(), testing::HasSubstr("is not a whole number that can stand there")) << key << " " << number;
      }
    }
  }
}

TEST(RunRecord, PartsCarryTheirFramesInTheName) {
  EXPECT_EQ(timing_file_name("out/f", "1-100", true), "out/f.timing.1-100.csv");
  EXPECT_EQ(timing_file_name("out/f", "1-100", false), "out/f.timing.csv");
  EXPECT_EQ(run_record_file_name("out/f", "1,5,9-12", true), "out/f.run.1,5,9-12.json");
  EXPECT_EQ(run_record_file_name("out/f", "1", false), "out/f.run.json");
  EXPECT_EQ(run_record_file_name("out/", "1", false), "out/run.json");
  // Names stay below the 255 bytes of common file systems, and distinct.
  std::string frames = "1";
  for (int i = 3; i < 1000; i += 2) {
    frames += "," + std::to_string(i);
  }
  const std::string name = timing_file_name("", frames, true);
  EXPECT_LT(name.size(), 200U);
  EXPECT_NE(name, timing_file_name("", frames + ",2000", true));
}

}  // namespace
}  // namespace gazetrace::run_record_test
