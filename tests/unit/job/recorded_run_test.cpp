// SPDX-License-Identifier: Apache-2.0
// What is known of a run from its record, when the scene and perhaps the gaze log are not there any more.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "gazetrace/error.hpp"
#include "gazetrace/recorded_run.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::recorded_run_test {
namespace {

class RecordedRuns : public testing::Test {
 protected:
  RecordedRuns() {
    write_text_atomically(log_,
                          "# display_px 1600 900\n# display_mm 480 270\n# distance_mm 650\n"
                          "t[ms],x[px],y[px]\n0,800,450\n10,801,450\n");
    set_option(job_, "scene", folder_ / "gone.gltf");
    set_option(job_, "gaze", log_);
    set_option(job_, "output", log_ + "/f.####.exr");  // a folder that cannot be
    set_option(job_, "fps", "24");
  }
  std::optional<RecordedRun> found(const std::string& digest = "d1") {
    RunRecord record;
    record.version = "0.1.0";
    record.config_toml = changed_(job_as_toml(job_));
    record.settings_digest = "d1";
    record.part_digests = {"d2", "d3"};
    record.facts["view"] = "a view";
    write_text_atomically(folder_ / record_name_, run_record_json(record));
    return find_recorded_run(folder_ / "f.####.exr", digest);
  }

  TemporaryFolder folder_;
  std::string record_name_ = "f.run.json";
  std::string log_ = folder_ / "log.csv";
  Job job_;
  std::function<std::string(std::string)> changed_ = [](std::string toml) { return toml; };  // before it is recorded
};

// Pictures that are finished are of use whatever has become of the options that made them.
TEST_F(RecordedRuns, FormerOptionsAndValuesThatAreGoneArePassedOver) {
  changed_ = [](std::string toml) {
    const std::string now = "filter = \"auto\"";
    const std::size_t at = toml.find(now);
    EXPECT_NE(at, std::string::npos) << toml;
    return toml.replace(at, now.size(), "filter = \"tent\"") + "\nbvh = \"high\"\n";
  };
  const std::optional<RecordedRun> run = found();
  ASSERT_TRUE(run);
  EXPECT_EQ(run->settings().filter, JobSettings().filter);
}

TEST_F(RecordedRuns, TheScreenIsThatOfTheLogWhereNoneIsStated) {
  const std::optional<RecordedRun> run = found();
  ASSERT_TRUE(run);
  EXPECT_EQ(run->view, "a view");
  EXPECT_EQ(run->settings().fps.numerator, 24);
  ASSERT_TRUE(run->resolved.plan_settings.display);
  EXPECT_EQ(run->resolved.plan_settings.display->width_px, 1600);
  EXPECT_EQ(run->resolved.plan_settings.display->distance_cm, 65);
}

TEST_F(RecordedRuns, RecordsOfTheVersionBeforeAndOfPicturesOfAnotherNameAreFound) {
  for (const char* name : {"run.json", "beauty.run.json"}) {
    record_name_ = name;
    EXPECT_TRUE(found()) << name;
    EXPECT_FALSE(found("d4")) << name;
    std::filesystem::remove(folder_ / name);
  }
}

TEST_F(RecordedRuns, ALogThatIsGoneLeavesTheScreenUnknown) {
  std::filesystem::remove(log_);
  set_option(job_, "output", folder_ / "f.####.exr");
  const std::optional<RecordedRun> run = found();
  ASSERT_TRUE(run);
  EXPECT_FALSE(run->resolved.plan_settings.display);
}

TEST_F(RecordedRuns, TheLogIsNotReadWhereTheScreenIsStated) {
  write_text_atomically(log_, "no gaze at all\n");
  ASSERT_TRUE(found());
  EXPECT_FALSE(found()->resolved.plan_settings.display) << "another file has the log's name: it says nothing";
  set_option(job_, "screen", "paper");
  set_option(job_, "frame-rect", "10,20,320,180");
  const std::optional<RecordedRun> run = found();
  ASSERT_TRUE(run);
  EXPECT_EQ(run->resolved.plan_settings.display->width_px, display_by_name("paper").width_px);
  EXPECT_EQ(run->resolved.plan_settings.frame_rect.x_px, 10);
}

TEST_F(RecordedRuns, ARecordOfOtherPicturesSaysNothing) {
  EXPECT_TRUE(found("d3")) << "a part of the run";
  EXPECT_FALSE(found("d4"));
  EXPECT_FALSE(find_recorded_run("nowhere/f.####.exr", "d1"));
}

}  // namespace
}  // namespace gazetrace::recorded_run_test
