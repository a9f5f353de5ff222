// SPDX-License-Identifier: Apache-2.0
// Which frames are scored, what the wrong gazes of a control are, and pictures on fewer pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "sweep/frames.hpp"
#include "sweep/pictures.hpp"
#include "sweep/rows.hpp"

namespace gazetrace::sweep_frames_test {
namespace {

constexpr std::int64_t kFrameNs = 40'000'000;  // 25 a second

// 100 x 60 pixels, 100 x 60 cm at 50 cm; the gaze of frame k at pixel (10 k, 30).
FramePlan plan_of(int frames) {
  FramePlan plan;
  for (int k = 1; k <= frames; ++k) {
    FrameRequest request;
    request.frame = k;
    request.t_video_ns = k * kFrameNs;
    request.width_px = 100;
    request.height_px = 60;
    request.view = view_of_display({100, 60, 100, 60, 50}, {}, 100, 60);
    request.gaze_true.state = GazeState::measured;
    request.gaze_true.movement = EyeMovement::fixation;
    request.gaze_direction_true = request.view.direction(10.0 * k, 30);
    request.gaze_direction_render = request.gaze_direction_true;
    request.gaze_render.u = 0.1 * k;
    plan.frames.push_back(request);
  }
  return plan;
}

double pixel_x(const FrameRequest& request) {
  return request.view.pixel(*request.gaze_direction_render).x;
}

TEST(SweepFrames, InFlightLastsTillAHundredMillisecondsAfterTheSaccade) {
  FramePlan plan = plan_of(8);
  plan.frames[2].gaze_true.movement = EyeMovement::saccade;
  plan.frames[3].gaze_true.since_saccade_ns = kFrameNs;
  plan.frames[4].gaze_true.since_saccade_ns = 2 * kFrameNs;
  plan.frames[5].gaze_true.since_saccade_ns = 3 * kFrameNs;
  plan.frames[6].gaze_true.movement = EyeMovement::blink;
  plan.frames[7].gaze_direction_true.reset();
  const std::vector<ResultFrame> frames = sweep_frames(plan, {}, 0.04);
  std::vector<std::string> events;
  for (const ResultFrame& frame : frames) {
    events.push_back(frame.event);
  }
  // Frames are 40 ms apart: 80 ms after the saccade the eye is still in flight, 120 ms after it is not.
  EXPECT_EQ(events, (std::vector<std::string>{"start", "fixation", "in-flight", "in-flight", "in-flight", "fixation",
                                              "blink", "none"}));
  const std::vector<bool> fixations{false, true, false, false, false, true, false, false};
  EXPECT_EQ(scored_frames(frames), fixations);
  EXPECT_DOUBLE_EQ(event_shares(frames).at("in-flight"), 3.0 / 7);
  EXPECT_NEAR(frames[1].gaze_px->x, 20, 1e-9);
}

TEST(SweepFrames, WithoutFixationsAllWithGazeAreScoredAndWithoutGazeAll) {
  FramePlan plan = plan_of(3);
  for (FrameRequest& request : plan.frames) {
    request.gaze_true.movement = EyeMovement::saccade;
  }
  plan.frames[1].gaze_true.movement = EyeMovement::blink;
  EXPECT_EQ(scored_frames(sweep_frames(plan, {}, 0)), (std::vector<bool>{true, false, true}));
  for (FrameRequest& request : plan.frames) {
    request.gaze_true.no_gaze = true;
    request.gaze_true.movement.reset();
  }
  EXPECT_EQ(scored_frames(sweep_frames(plan, {}, 0.02)), (std::vector<bool>{false, true, true}));
}

TEST(SweepFrames, RingsAreWhereTheAnglesAreInTheMiddle) {
  FoveationSettings foveation;
  std::get<RegionSampling>(foveation.sampling).eccentricities_deg = {5, 15};
  // A pixel is a centimetre at 50 cm: tan(5 deg) * 50 and tan(15 deg) * 50 pixels.
  const std::vector<ResultFrame> frames = sweep_frames(plan_of(1), foveation, 0);
  ASSERT_EQ(frames[0].rings_px.size(), 2U);
  EXPECT_NEAR(frames[0].rings_px[0], 50 * std::tan(5 * kPi / 180), 1e-9);
  EXPECT_NEAR(frames[0].rings_px[1], 50 * std::tan(15 * kPi / 180), 1e-9);
}

TEST(SweepFrames, AWrongGazeSteersAndTheTrueOneStays) {
  const FramePlan plan = plan_of(9);
  const auto mirrored = with_wrong_gaze(plan, "mirrored");
  const auto center = with_wrong_gaze(plan, "center");
  const auto shuffled = with_wrong_gaze(plan, "shuffled");
  ASSERT_TRUE(mirrored && center && shuffled);
  std::set<double> before;
  std::set<double> after;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const double x = pixel_x(plan.frames[i]);
    EXPECT_NEAR(pixel_x(mirrored->frames[i]), 100 - x, 1e-9);
    EXPECT_NEAR(mirrored->frames[i].gaze_render.u, 1 - x / 100, 1e-9);
    EXPECT_NEAR(pixel_x(center->frames[i]), 50, 1e-9);
    EXPECT_NE(pixel_x(shuffled->frames[i]), x) << i;
    EXPECT_EQ(shuffled->frames[i].gaze_direction_true, plan.frames[i].gaze_direction_true);
    before.insert(x);
    after.insert(pixel_x(shuffled->frames[i]));
  }
  EXPECT_EQ(before, after);
}

TEST(SweepFrames, AWrongGazeSteersTheFramesAroundAndTheJudgedOnesAsWell) {
  FramePlan plan = plan_of(9);
  plan.around = {plan.frames[8]};
  plan.frames.pop_back();
  plan.judged.runs = {{plan.frames[0], plan.frames[1]}};
  for (const std::string& wrong : wrong_gazes()) {
    const auto other = with_wrong_gaze(plan, wrong);
    ASSERT_TRUE(other);
    ASSERT_EQ(other->around.size(), 1U) << wrong;
    EXPECT_NE(pixel_x(other->around[0]), 90) << wrong;
    EXPECT_NE(pixel_x(other->judged.runs[0][0]), 10) << wrong;
  }
  EXPECT_NEAR(pixel_x(with_wrong_gaze(plan, "mirrored")->around[0]), 10, 1e-9);
  const FramePlan small = resized(plan, {50, 30});
  EXPECT_EQ(small.around[0].width_px, 50);
  EXPECT_EQ(small.judged.runs[0][1].view.width_px, 50);
}

TEST(SweepRows, RatesThatFollowAPictureHaveBaselinesWithoutGaze) {
  SweepPlan plan;
  plan.scenes.resize(1);
  SweepTest test;
  test.plan = plan_of(1);
  test.plan.frames[0].gaze_direction_render.reset();
  test.pipeline.foveation.sampling = AdaptiveSampling{};
  plan.tests = {test};
  plan.measure.baselines.reference_rate = true;
  plan.measure.baselines.wrong_gaze = true;
  std::vector<std::string> notes;
  const std::vector<PlannedRow> rows = baselines_known_before(plan, test_row(plan, 0), notes);
  ASSERT_EQ(rows.size(), 1U);  // there is no gaze that could be wrong
  EXPECT_EQ(rows[0].row.role, RowRole::uniform_reference_rate);
  EXPECT_TRUE(notes.empty());
  plan.tests[0].pipeline.foveation.sampling = RegionSampling{};
  EXPECT_TRUE(baselines_known_before(plan, test_row(plan, 0), notes).empty());
}

TEST(SweepFrames, AWrongGazeThatIsTheRightOneIsNoControl) {
  FramePlan still = plan_of(3);
  for (FrameRequest& request : still.frames) {
    request.gaze_direction_render = request.view.direction(50, 30);
  }
  for (const std::string& wrong : wrong_gazes()) {
    EXPECT_FALSE(with_wrong_gaze(still, wrong)) << wrong;
  }
}

TEST(SweepFrames, FewerPixelsOfTheSameAspectAndExtent) {
  const RasterSize size = scaled_size({3840, 2160}, std::sqrt(1.04 / 32));
  EXPECT_EQ(size.width_px * 9, size.height_px * 16);
  EXPECT_NEAR(static_cast<double>(size.width_px) * size.height_px / (3840.0 * 2160), 1.04 / 32, 1e-3);
  EXPECT_EQ(scaled_size({3840, 2160}, 1).width_px, 3840);
  EXPECT_EQ(scaled_size({101, 67}, 0.5).width_px, 51);
  const FramePlan small = resized(plan_of(1), {50, 30});
  const PlanarView& view = small.frames[0].view;
  EXPECT_NEAR(view.direction(50, 30).x, plan_of(1).frames[0].view.direction(100, 60).x, 1e-12);
  EXPECT_EQ(small.frames[0].width_px, 50);
}

TEST(SweepPictures, UpscalingKeepsRampsAndMeans) {
  ImageRgb ramp(8, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      ramp(x, y) = {static_cast<float>(x) + 0.5F, 1, static_cast<float>(y)};
    }
  }
  const ImageRgb large = upscaled(ramp, 32, 16, 1);
  // Away from the border a linear picture stays the same line: the value at x is x / 4.
  for (int x = 2; x < 30; ++x) {
    EXPECT_NEAR(large(x, 8).x, (static_cast<float>(x) + 0.5F) / 4, 1e-5) << x;
  }
  EXPECT_EQ(large(0, 0).x, 0.5F);
  EXPECT_EQ(large(31, 15).z, 3.0F);
  EXPECT_EQ(upscaled(ramp, 8, 4, 1), ramp);
}

}  // namespace
}  // namespace gazetrace::sweep_frames_test
