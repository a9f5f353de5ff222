// SPDX-License-Identifier: Apache-2.0
// Which frames a stated quality is judged by, from a job to its plan.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "gazetrace/resolve.hpp"
#include "pipeline/quality/discarded.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::judged_plan_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class JudgedPlan : public testing::Test {
 protected:
  JudgedPlan() {
    set_option(job_, "scene", GAZETRACE_SOURCE_DIR "/tests/data/package/triangle.gltf");
    set_option(job_, "gaze-at", "0.5,0.5");
    set_option(job_, "eye", "0,0,3");
    set_option(job_, "target", "0,0,0");
    set_option(job_, "size", "32x18");
    set_option(job_, "screen-px", "32,18");
    set_option(job_, "screen-ppd", "10");
    set_option(job_, "target-jod", "9");
  }
  // A second of gaze that rests in the middle, but for a look aside in between.
  void follow_a_log() {
    std::string log = "# gazetrace-gaze 1\nt[ns],u,v\n";
    for (int i = 0; i < 100; ++i) {
      log += fmt::format("{},{},0.5\n", i * 10'000'000, i > 25 && i < 40 ? 0.9 : 0.5);
    }
    write_text_atomically(folder_ / "log.csv", log);
    job_.settings.gaze_at.reset();
    set_option(job_, "gaze", folder_ / "log.csv");
  }
  void glide(const std::string& until_s) {
    write_text_atomically(folder_ / "path.csv",
                          "t[s],x[m],y[m],z[m],qx,qy,qz,qw\n0,0,0,3,0,0,0,1\n" + until_s + ",0.1,0,3,0,0,0,1\n");
    job_.settings.eye.reset();
    job_.settings.target.reset();
    set_option(job_, "camera-path", folder_ / "path.csv");
  }
  [[nodiscard]] ResolvedJob planned(ResolveScope scope = ResolveScope::plan) const {
    ResolveOptions options;
    options.scope = scope;
    return resolve(job_, options);
  }
  [[nodiscard]] JudgedFrames judged() const { return planned().plan.judged; }
  [[nodiscard]] std::string refusal() const {
    try {
      (void)planned();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  Job job_;
};

TEST_F(JudgedPlan, GazeOfALogMayLookElsewhereBetweenTheJudgedFrames) {
  EXPECT_FALSE(judged().gaze_moves);
  follow_a_log();
  set_option(job_, "frames", "1-24");
  EXPECT_TRUE(judged().gaze_moves);
}

TEST_F(JudgedPlan, AStillAtTheEndOfItsPathIsJudgedByExamplesOfItsOneFrame) {
  glide("0.03");
  const JudgedFrames still = judged();
  EXPECT_EQ(still.sequence_frames, 1);
  ASSERT_EQ(still.runs.size(), 4U);
  for (std::size_t k = 0; k < still.runs.size(); ++k) {
    ASSERT_EQ(still.runs[k].size(), 1U);
    EXPECT_EQ(still.runs[k][0].frame, static_cast<std::int32_t>(k) + 1);  // so that its samples are its own
    EXPECT_EQ(still.runs[k][0].camera.pose.position_m.x, still.runs[0][0].camera.pose.position_m.x);
  }
}

TEST_F(JudgedPlan, FramesTooSlowForTheMeasureAreRefused) {
  set_option(job_, "fps", "4");
  set_option(job_, "frames", "1-10");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("`target-jod`: 4 frames a second"), HasSubstr("higher `fps`")));
}

TEST_F(JudgedPlan, ThePartsOfASequenceHaveOneDigestAndAStillHasAnother) {
  const auto digest = [&](const char* frames) {
    job_.settings.frames.reset();
    if (*frames != 0) {
      set_option(job_, "frames", frames);
    }
    return planned(ResolveScope::digests).pipeline.settings_digest;
  };
  EXPECT_EQ(digest("1-24"), digest("7-9"));
  EXPECT_NE(digest(""), digest("1-24"));  // a still, and a second of rest
  write_text_atomically(folder_ / "look.csv", "# gazetrace-gaze 1\nt[ns],u,v\n0,0.5,0.5\n");
  job_.settings.gaze_at.reset();
  set_option(job_, "gaze", folder_ / "look.csv");
  EXPECT_NE(digest(""), digest("1"));  // of a single look, too
  glide("2");
  EXPECT_EQ(digest(""), digest("1-24"));
  glide("0.03");
  EXPECT_EQ(digest(""), digest("1"));  // the only frame that there is
}

// Finding a recorded run again loads no scene but where its animation says how long the sequence is.
TEST_F(JudgedPlan, AnAnimatedSceneHasTheSameDigestWhenItIsRenderedAndWhenItIsFoundAgain) {
  const std::string scene = GAZETRACE_SHARED_DIR "/scenes/small/AnimatedMorphCube/AnimatedMorphCube.gltf";
  if (!std::filesystem::exists(scene)) {
    GTEST_SKIP() << "the folder of real scenes is not here";
  }
  set_option(job_, "scene", scene);
  set_option(job_, "frames", "1-2");
  EXPECT_EQ(planned(ResolveScope::render).pipeline.settings_digest,
            planned(ResolveScope::digests).pipeline.settings_digest);
}

TEST_F(JudgedPlan, DiscardedRenderingsTraceNoLayers) {
  FrameSettings settings;
  settings.layers.light = settings.layers.forward = true;
  const FrameSettings own = discarded(settings, 1);
  EXPECT_FALSE(own.layers.light || own.layers.forward);
}

// A frame whose size follows from its screen: what is asked of single pixels is checked against that size.
TEST_F(JudgedPlan, ASinglePixelMustLieInTheFrameThatTheScreenShapes) {
  Job job = job_;
  job.settings.foveation.target = {};
  job.settings.size = JobSettings{}.size;
  job.sources.erase("size");
  ResolveOptions plan;
  plan.scope = ResolveScope::plan;
  set_option(job, "screen-px", "3440,1440");
  set_option(job, "only-pixel", "100,600");
  EXPECT_THROW((void)resolve(job, plan), Error);  // of 1280x536
  set_option(job, "screen-px", "1440,3440");
  set_option(job, "only-pixel", "100,2000");
  EXPECT_NO_THROW((void)resolve(job, plan));  // of 1280x3058
}

}  // namespace
}  // namespace gazetrace::judged_plan_test
