// SPDX-License-Identifier: Apache-2.0
// A run by the library alone: from a job to files and their record.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/recorded_run.hpp"
#include "gazetrace/resolve.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::job_resolve_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kFirstNs = 1698682600011534600;  // 30 October 2023
constexpr const char* kStamp = "16986826";

class Resolve : public testing::Test {
 protected:
  Resolve() {
    std::string log = "# gazetrace-gaze 1\n# clock host, 2023/10/30 13:34:49.156\nt[ns],dx,dy,dz\n";
    for (int i = 0; i < 60; ++i) {
      log += fmt::format("{},{},0,-1\n", kFirstNs + i * 10'000'000, 0.001 * i);
    }
    write_text_atomically(folder_ / "log.csv", log);
    set_option(job_, "scene", GAZETRACE_SOURCE_DIR "/tests/data/package/triangle.gltf");
    set_option(job_, "gaze", folder_ / "log.csv");
    set_option(job_, "eye", "0,0,3");
    set_option(job_, "target", "0,0,0");
    set_option(job_, "size", "32x18");
    set_option(job_, "spp", "1");
    set_option(job_, "frames", "1-2");
    set_option(job_, "output", folder_ / "f.####.exr");
  }
  // As a program does that has nothing but the library.
  static std::string rendered(const Job& job) {
    ResolvedJob resolved = resolve(job);
    prepare_outputs(resolved);
    const ColorPipeline color(resolved.job.settings.color);
    PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
    RunRecord record = start_run_record(resolved, tracer, color);
    const SequenceResult result = render_sequence(tracer, resolved.plan, color, resolved.pipeline, {});
    finish_run_record(record, result, resolved.plan, 1.0);
    return run_record_json(record);
  }

  TemporaryFolder folder_;
  Job job_;
};

TEST_F(Resolve, ARecordOfAnEmbeddedRunCarriesNoTimeOfDay) {
  const std::string record = rendered(job_);
  EXPECT_THAT(record, Not(HasSubstr(kStamp)));
  EXPECT_THAT(record, Not(HasSubstr("2023/10/30")));
  EXPECT_THAT(record, HasSubstr("\"state\": \"done\""));
  for (const char* name : {"f.0001.exr", "f.0002.exr", "f.timing.csv"}) {
    EXPECT_THAT(file_bytes(folder_ / name), Not(HasSubstr(kStamp))) << name;
  }
}

// So that the test above would see one.
TEST_F(Resolve, WhoAsksForTimesOfDayGetsThem) {
  set_option(job_, "keep-ids", "true");
  rendered(job_);
  EXPECT_THAT(file_bytes(folder_ / "f.0001.exr"), HasSubstr(kStamp));
}

TEST_F(Resolve, SaysWhatItDecidedAndWhy) {
  const ResolvedJob resolved = resolve(job_);
  EXPECT_EQ(resolved.job.settings.filter, "guided");
  std::map<std::string, std::string> decisions(resolved.decisions.begin(), resolved.decisions.end());
  EXPECT_THAT(decisions.at("filter"), HasSubstr("guided, because"));
  EXPECT_EQ(decisions.at("camera"), "still, from `eye`");
  EXPECT_THAT(decisions.at("environment"), HasSubstr("the built-in sky"));
  EXPECT_EQ(resolved.pipeline.reconstruction.filter, "guided");
  set_option(job_, "filter", "linear");
  const ResolvedJob named = resolve(job_);
  decisions = {named.decisions.begin(), named.decisions.end()};
  EXPECT_FALSE(decisions.contains("filter"));
}

// How many frames there are is what a plan is asked for; only a run has to have a name for each.
TEST_F(Resolve, APlanMayHaveMoreFramesThanItsOutputHasNames) {
  set_option(job_, "output", folder_ / "one.exr");
  Job job = job_;
  job.settings.frames.reset();
  ResolveOptions plan;
  plan.scope = ResolveScope::plan;
  EXPECT_GT(resolve(job, plan).frames.size(), 1U);
  EXPECT_THROW((void)resolve(job), Error);
}

TEST_F(Resolve, TheSameFilesUnderOtherNamesHaveTheSameDigests) {
  const std::string digest = resolve(job_).pipeline.settings_digest;
  EXPECT_FALSE(digest.empty());
  write_text_atomically(folder_ / "other.csv", file_bytes(folder_ / "log.csv"));
  Job other = job_;
  set_option(other, "gaze", folder_ / "other.csv");
  EXPECT_EQ(resolve(other).pipeline.settings_digest, digest);
  set_option(other, "seed", "7");
  EXPECT_NE(resolve(other).pipeline.settings_digest, digest);
}

TEST_F(Resolve, ARecordGivesTheSameDigestAgain) {
  const ResolvedJob resolved = resolve(job_);
  const PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
  const RunRecord record = start_run_record(resolved, tracer, ColorPipeline({}));
  EXPECT_EQ(resolve(job_of_record(record, "run.json")).pipeline.settings_digest, record.settings_digest);
}

TEST_F(Resolve, APlanNeedsNoSceneAndHashesNothing) {
  set_option(job_, "scene", folder_ / "gone.gltf");
  ResolveOptions options;
  options.scope = ResolveScope::plan;
  const ResolvedJob resolved = resolve(job_, options);
  EXPECT_EQ(resolved.plan.frames.size(), 2U);
  EXPECT_EQ(resolved.scene, nullptr);
  EXPECT_TRUE(resolved.input_digests.empty());
}

TEST_F(Resolve, FramesHaveWhatTheirChannelsShow) {
  set_option(job_, "filter", "linear");
  for (const char* aov : {"", "albedo", "normal", "depth"}) {
    Job job = job_;
    if (*aov != 0) {
      set_option(job, "aov", aov);
    }
    ResolvedJob resolved = resolve(job);
    PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
    const FrameRenderer renderer(tracer, resolved.pipeline);
    const Frame frame = renderer.render(resolved.plan.frames.front()).frame;
    const std::size_t pixels = *aov != 0 ? frame.radiance.pixels.size() : 0;
    EXPECT_EQ(frame.albedo.pixels.size(), pixels) << aov;
    EXPECT_EQ(frame.normal.pixels.size(), pixels) << aov;
    EXPECT_EQ(frame.depth_m.pixels.size(), pixels) << aov;
  }
}

// Pictures that exist already can be looked at without what they were rendered from.
TEST_F(Resolve, ViewingNeedsNeitherSceneNorOutputs) {
  set_option(job_, "scene", folder_ / "gone.gltf");
  set_option(job_, "output", folder_ / "log.csv/f.####.exr");
  set_option(job_, "screen", "paper");
  set_option(job_, "frame-rect", "10,20,320,180");
  set_option(job_, "gaze-start", fmt::format("{}ns", kFirstNs + 100'000'000));
  EXPECT_THROW(check_job(job_), Error);
  ResolveOptions options;
  options.scope = ResolveScope::viewing;
  const ResolvedJob resolved = resolve(job_, options);
  ASSERT_TRUE(resolved.plan_settings.display);
  EXPECT_EQ(resolved.plan_settings.display->width_px, display_by_name("paper").width_px);
  EXPECT_EQ(resolved.plan_settings.frame_rect.y_px, 20);
  ASSERT_TRUE(resolved.gaze);
  EXPECT_LT(resolved.gaze->samples.front().t_ns, kFirstNs) << "a time of day";
  // The eleventh sample, below three lines of head.
  EXPECT_EQ(gaze_at(*resolved.gaze, resolved.plan_settings.gaze, 0).row_before, 3 + 11);
  EXPECT_TRUE(resolved.plan.frames.empty());
  EXPECT_TRUE(resolved.input_digests.empty());
}

// An empty digest would match every file that has none.
TEST_F(Resolve, ResumingWithoutADigestIsAnErrorAndNoMatch) {
  set_option(job_, "resume", "true");
  ResolvedJob resolved = resolve(job_);
  PathTracer tracer(*resolved.scene, {});
  const ColorPipeline color({});
  write_text_atomically(folder_ / "f.0001.exr", "something else");
  resolved.pipeline.settings_digest.clear();
  try {
    render_sequence(tracer, resolved.plan, color, resolved.pipeline, {});
    FAIL() << "it went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("`resume`: no settings digest"));
  }
  EXPECT_EQ(file_bytes(folder_ / "f.0001.exr"), "something else");
}

// The triangle's corners in the frame: the outermost one is near the edge and none is beyond it.
TEST_F(Resolve, AnObjectWithoutACameraFillsTheFrame) {
  Job job = job_;
  job.settings.eye.reset();
  job.settings.target.reset();
  for (const char* size : {"32x18", "20x40", "90x10"}) {
    set_option(job, "size", size);
    const ResolvedJob resolved = resolve(job);
    const Camera& camera = resolved.plan.frames.front().camera;
    const double slope = std::tan(camera.projection.yfov_rad / 2);
    const double aspect = static_cast<double>(resolved.job.settings.size.width) / resolved.job.settings.size.height;
    const Quatd& turned = camera.pose.orientation;
    const Quatd back{-turned.x, -turned.y, -turned.z, turned.w};
    double most = 0;
    for (const Instance& instance : resolved.scene->instances) {
      for (const Vec3f& p : resolved.scene->meshes[static_cast<std::size_t>(instance.mesh)].geometries[0].positions) {
        const Vec3d world = transform_point(instance.to_world, {p.x, p.y, p.z});
        const Vec3d seen = rotate(back, world - camera.pose.position_m);
        ASSERT_LT(seen.z, 0);
        most = std::max({most, std::abs(seen.x / -seen.z) / (slope * aspect), std::abs(seen.y / -seen.z) / slope});
      }
    }
    EXPECT_GT(most, 0.9) << size;
    EXPECT_LT(most, 0.97) << size;
  }
}

TEST_F(Resolve, AFrameWithoutASizeHasTheShapeOfTheScreen) {
  Job job;
  for (const char* option : {"scene", "eye", "target", "spp", "frames"}) {
    set_option(job, option, option_values(job_, option));
  }
  set_option(job, "gaze-at", "0.5,0.5");
  set_option(job, "screen-px", "1600,1200");
  set_option(job, "screen-cm", "40,30");
  set_option(job, "screen-distance-cm", "60");
  ResolveOptions plan;
  plan.scope = ResolveScope::plan;
  const ResolvedJob resolved = resolve(job, plan);
  EXPECT_EQ(resolved.job.settings.size.width, 1280);
  EXPECT_EQ(resolved.job.settings.size.height, 960);
  EXPECT_EQ(resolved.plan.frames.front().height_px, 960);
  const std::map<std::string, std::string> decisions(resolved.decisions.begin(), resolved.decisions.end());
  EXPECT_THAT(decisions.at("size"), HasSubstr("1280x960"));
  set_option(job, "size", "1280x720");  // asked for: it does not have the shape of the screen
  EXPECT_THROW((void)resolve(job, plan), Error);
}

// The display shows so few pixels a degree that all of what they can show is seen at every eccentricity.
TEST_F(Resolve, AFallOffThatSavesNothingIsTold) {
  Job job = job_;
  job.settings.gaze = {};
  set_option(job, "gaze-at", "0.5,0.5");
  set_option(job, "screen-px", "1920,1080");
  set_option(job, "screen-cm", "60,33.75");
  set_option(job, "screen-distance-cm", "60");
  set_option(job, "density", "geisler-perry");
  job.settings.foveation.spp.reset();
  set_option(job, "size", "160x90");
  ResolveOptions plan;
  plan.scope = ResolveScope::plan;
  EXPECT_THAT(resolve(job, plan).warnings,
              testing::Contains(testing::AllOf(HasSubstr("geisler-perry saves only 1.0"), HasSubstr("`size`"))));
  set_option(job, "size", "1920x1080");
  EXPECT_THAT(resolve(job, plan).warnings, Not(testing::Contains(HasSubstr("saves only"))));
  set_option(job, "size", "160x90");
  set_option(job, "density", "geisler-perry:relative-to=fovea");
  EXPECT_THAT(resolve(job, plan).warnings, Not(testing::Contains(HasSubstr("saves only"))));
}

TEST_F(Resolve, PixelsThatALogCallsFractionsAreTold) {
  const auto warnings_of = [&](const std::string& rows) {
    write_text_atomically(folder_ / "places.csv", "# gazetrace-gaze 1\nt[ns],u,v\n" + rows);
    Job job = job_;
    set_option(job, "gaze", folder_ / "places.csv");
    set_option(job, "screen", "paper");
    set_option(job, "size", "64x36");
    return fmt::format("{}", fmt::join(resolve(job).warnings, "\n"));
  };
  EXPECT_THAT(warnings_of("0,955,538\n10000000,964,541\n20000000,0.5,-0.1\n"),
              AllOf(HasSubstr("places.csv: the positions are no fractions of the display but pixels"),
                    HasSubstr("give `unit` px")));
  // Beside the screen, and one mark of a missing value.
  EXPECT_THAT(warnings_of("0,1.2,0.5\n10000000,-0.4,2\n20000000,-100,-100\n"), Not(HasSubstr("but pixels")));
  EXPECT_THAT(fmt::format("{}", fmt::join(resolve(job_).warnings, "\n")), Not(HasSubstr("but pixels")));
}

TEST_F(Resolve, AnAnchorAgesAwayFromTheLogIsRefused) {
  set_option(job_, "gaze-anchor", "-9000000000s=0s");
  EXPECT_THAT([&] { resolve(job_); },
              testing::ThrowsMessage<Error>(HasSubstr("`gaze-anchor`: -9000000000s lies ages away from the log")));
}

// What a run of the version before has left under the name of no sequence is taken up by a run that goes on.
TEST_F(Resolve, RecordsUnderFormerNamesAreTakenUp) {
  const std::string record = rendered(job_);
  write_text_atomically(folder_ / "run.json", record);
  std::filesystem::rename(folder_ / "f.timing.csv", folder_ / "timing.csv");
  const std::string rows = file_bytes(folder_ / "timing.csv");
  set_option(job_, "resume", "true");
  Job other = job_;
  set_option(other, "output", std::vector{folder_ / "g.####.exr"});
  prepare_outputs(resolve(other));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "g.run.json")) << "the record was that of f";
  prepare_outputs(resolve(job_));
  EXPECT_EQ(file_bytes(folder_ / "f.run.json"), record);
  EXPECT_EQ(file_bytes(folder_ / "f.timing.csv"), rows);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.json"));
}

TEST_F(Resolve, StillsHaveRecordsOfTheirOwn) {
  Job job = job_;
  set_option(job, "frames", "1");
  set_option(job, "output", std::vector{folder_ / "one.exr", folder_ / "shown.png"});
  const std::string record = rendered(job);
  const ResolvedJob resolved = resolve(job);
  EXPECT_EQ(output_files(resolved.pipeline, resolved.frames).front(), folder_ / "one.run.json");
  write_text_atomically(folder_ / "one.run.json", record);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "one.timing.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.json"));
  const std::string digest = resolved.pipeline.settings_digest;
  for (const char* name : {"one.exr", "shown.png"}) {
    EXPECT_TRUE(find_recorded_run(folder_ / name, digest)) << name;
    EXPECT_FALSE(find_recorded_run(folder_ / name, "another")) << name;
  }
}

}  // namespace
}  // namespace gazetrace::job_resolve_test
