// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/run_job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "gazetrace/compare_job.hpp"
#include "gazetrace/job.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::run_job_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class RunJob : public testing::Test {
 protected:
  RunJob() {
    set_option(job_, "scene", GAZETRACE_SOURCE_DIR "/tests/data/package/triangle.gltf");
    set_option(job_, "eye", "0,0,3");
    set_option(job_, "target", "0,0,0");
    set_option(job_, "size", "32x18");
    set_option(job_, "screen-px", "32,18");
    set_option(job_, "screen-ppd", "20");
    set_option(job_, "frames", "1-3");
    set_option(job_, "gaze-at", "0.5,0.5");
    set_option(job_, "output", folder_ / "f.####.exr");
  }
  Job into(const std::string& pattern) const {
    Job job = job_;
    set_option(job, "output", folder_ / pattern);
    return job;
  }

  TemporaryFolder folder_;
  Job job_;
};

TEST_F(RunJob, LeavesPicturesTableAndRecord) {
  std::vector<std::string> seen;
  RunObserver observer;
  observer.loading = [&](std::size_t, std::size_t) { seen.assign(1, "loading"); };
  observer.building_tree = [&] { seen.emplace_back("tree"); };
  observer.begins = [&](const StartedRun& run) {
    seen.emplace_back("begins");
    EXPECT_THAT(run.files, testing::Contains(folder_ / "f.0002.exr"));
  };
  observer.frame_done = [&](const TimingRow& row, bool) { seen.push_back(std::to_string(row.frame)); };
  RunOptions options;
  options.command_line = {"a", "program"};
  options.words = [](const std::string& text) { return "<" + text + ">"; };
  const FinishedRun run = run_job(job_, observer, options);
  EXPECT_EQ(seen.back(), "3");
  EXPECT_THAT(seen, testing::IsSupersetOf({"tree", "begins", "1", "2"}));
  EXPECT_EQ(run.result.rows.size(), 3U);
  EXPECT_EQ(run.record.facts.at("state"), "done");
  const RunRecord written = read_run_record(folder_ / "f.run.json");
  EXPECT_EQ(written.facts.at("state"), "<done>");
  EXPECT_EQ(written.files.size(), 3U);
  EXPECT_EQ(written.settings_digest, run.resolved.pipeline.settings_digest);
  EXPECT_EQ(read_timing_csv(folder_ / "f.timing.csv").size(), 3U);
  EXPECT_THAT([&] { run_job(job_); },
              testing::ThrowsMessage<Error>(HasSubstr("f.run.json: this output exists already")));
}

TEST_F(RunJob, IsEndedByItsObserverAndGoesOn) {
  RunObserver observer;
  int asked = 0;
  observer.stop_before_frame = [&](double) { return ++asked > 1; };
  const FinishedRun run = run_job(job_, observer);
  EXPECT_TRUE(run.result.interrupted);
  EXPECT_THAT(run.result.left, ElementsAre(2, 3));
  EXPECT_EQ(read_run_record(folder_ / "f.run.json").facts.at("state"), "interrupted");
  set_option(job_, "resume", "true");
  EXPECT_THAT(run_job(job_).result.skipped, ElementsAre(1));
  EXPECT_EQ(read_run_record(folder_ / "f.run.json").facts.at("state"), "done");
}

TEST_F(RunJob, ClaimsItsFiles) {
  Job other = into("f.%04d.exr");  // the same files, spelled otherwise
  set_option(other, "resume", "true");
  RunObserver observer;
  observer.begins = [&](const StartedRun&) {
    EXPECT_THAT([&] { run_job(other); }, testing::ThrowsMessage<Error>(HasSubstr("wait for it")));
    run_job(into("g.####.exr"));
  };
  run_job(job_, observer);
  EXPECT_THAT(run_job(other).result.skipped, ElementsAre(1, 2, 3));
}

// AOVs that no file holds are there for who looks at the frames.
TEST_F(RunJob, ShowsFramesThatNoFileHolds) {
  job_.settings.outputs.clear();
  set_option(job_, "aov", "albedo,depth");
  EXPECT_THROW(run_job(job_), Error);
  RunObserver observer;
  std::vector<std::size_t> albedo;
  observer.take_frame = [&](const FrameRequest&, RenderedFrame&& rendered, const TimingRow&) {
    albedo.push_back(rendered.frame.albedo.pixels.size());
  };
  RunOptions options;
  options.shows_frames = true;
  run_job(job_, observer, options);
  EXPECT_THAT(albedo, ElementsAre(576, 576, 576));
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(RunJob, NamesAreCheckedWhenTheyAreGiven) {
  const auto says = [](const char* words) { return testing::ThrowsMessage<Error>(HasSubstr(words)); };
  EXPECT_THAT([&] { set_option(job_, "sampling", "region"); }, says("did you mean 'regions'"));
  EXPECT_THAT([&] { set_option(job_, "filter", "guide"); }, says("did you mean 'guided'"));
  EXPECT_THAT([&] { set_option(job_, "density", "guided"); }, says("give one of these, or a file"));
  set_option(job_, "filter", "auto");
}

class CompareRuns : public RunJob {
 protected:
  CompareRuns() {
    run_job(into("a.####.exr"));
    Job test = into("b.####.exr");
    set_option(test, "seed", "5");
    run_job(test);
    asked_.reference = folder_ / "a.####.exr";
    asked_.test = folder_ / "b.####.exr";
    asked_.settings.metrics = {"mse", "flip"};
  }
  CompareJob asked_;
};

// Two sequences in one folder, each with a record of its own that knows screen and gaze.
TEST_F(CompareRuns, GeometryAndGazeComeFromTheRecords) {
  asked_.fail_above = {"flip=0", "mse=1e9"};
  asked_.json = folder_ / "scores.json";
  std::vector<std::int32_t> frames;
  const ComparedSequences compared = compare(asked_, [&](FrameScores& scores) { frames.push_back(scores.frame); });
  EXPECT_THAT(frames, ElementsAre(1, 2, 3));
  EXPECT_EQ(compared.frames.size(), 3U);
  EXPECT_EQ(compared.frames[1].gaze_class, GazeClass::fixation);
  EXPECT_GT(compared.frames[1].scores[0].bands[0].value_or(0), 0);
  EXPECT_THAT(compared.conditions, testing::Contains(testing::Pair("gaze", "of the reference's pictures")));
  EXPECT_THAT(compared.over_limits, ElementsAre(HasSubstr("above 0")));
  EXPECT_EQ(file_bytes(asked_.json), compare_json(compared));
  EXPECT_THAT([&] { compare(asked_); }, testing::ThrowsMessage<Error>(HasSubstr("give `overwrite`")));
}

TEST_F(CompareRuns, GazeOfAnotherPlaceIsRefused) {
  Job test = into("c.####.exr");
  set_option(test, "gaze-at", "0.2,0.5");
  run_job(test);
  asked_.test = folder_ / "c.####.exr";
  EXPECT_THAT([&] { compare(asked_); }, testing::ThrowsMessage<Error>(HasSubstr("was looked at in 0.2000,0.5000")));
  asked_.gaze_in_frame = {Vec2d{0.5, 0.5}, std::nullopt, Vec2d{0.5, 0.5}};
  const ComparedSequences given = compare(asked_);
  EXPECT_EQ(given.frames[0].gaze_class, GazeClass::fixation);
  EXPECT_EQ(given.frames[1].gaze_class, GazeClass::no_gaze);
  asked_.gaze_in_frame.pop_back();
  EXPECT_THAT([&] { compare(asked_); }, testing::ThrowsMessage<Error>(HasSubstr("2 places of gaze for 3 frames")));
  asked_.gaze_in_frame.clear();
  asked_.anyway = true;
  EXPECT_EQ(compare(asked_).frames.size(), 3U);
}

}  // namespace
}  // namespace gazetrace::run_job_test
