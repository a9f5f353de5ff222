// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "gazetrace/plan.hpp"

namespace gazetrace::plan_frames_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;

PlanSettings paper_settings() {
  PlanSettings settings;
  settings.frames = {1, 2, 3};
  settings.fps = {24, 1};
  settings.width_px = 1920;
  settings.height_px = 1080;
  settings.display = display_by_name("paper");
  return settings;
}

CameraPath still() {
  return static_camera(look_at({1, 2, 3}, {1, 2, 0}, {0, 1, 0}), {});
}

CameraPath moving(std::int64_t begin_ns, std::int64_t end_ns) {
  CameraPath path = still();
  path.source = "walk.txt";
  path.is_static = false;
  path.begin_ns = begin_ns;
  path.end_ns = end_ns;
  path.pose_at = [begin_ns, end_ns](std::int64_t t) {
    EXPECT_TRUE(t >= begin_ns && t <= end_ns) << t;
    return CameraPose{{static_cast<double>(t), 0, 0}, {}};
  };
  return path;
}

GazeLog screen_log() {
  GazeLog log;
  log.source = "gaze.csv";
  for (int i = 0; i < 40; ++i) {
    GazeSample sample;
    sample.t_ns = 5'000 * kMs + i * 4 * kMs;
    sample.u = 0.25 + 0.0125 * i;
    sample.v = 0.5;
    sample.row = i + 2;
    log.samples.push_back(sample);
  }
  return log;
}

std::string message_of(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings, ErrorKind kind) {
  try {
    plan_frames(camera, log, settings);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "no error";
}

TEST(PlanFrames, TimesAreMidExposureRoundedDown) {
  PlanSettings settings = paper_settings();
  settings.frames = {1, 2, 3, 100, 2147483647};
  settings.fps = {24000, 1001};
  settings.start_ns = -7;
  std::vector<std::int64_t> times;
  for (const FrameRequest& request : plan_frames(still(), nullptr, settings).frames) {
    times.push_back(request.t_video_ns);
  }
  // (2 k - 1) * 1001e9 / 48000 by hand: 20854166.67, 62562500, 104270833.33, 4149979166.67; the last by Python's
  // integers
  EXPECT_THAT(times, ElementsAre(20'854'166 - 7, 62'562'500 - 7, 104'270'833 - 7, 4'149'979'166 - 7,
                                 89'567'963'756'104'166 - 7));
}

// Numbers move, moments stay.
TEST(PlanFrames, FramesMayBeCountedFromAnyNumber) {
  PlanSettings settings = paper_settings();
  settings.fps = {24, 1};
  settings.first_frame = 1001;
  settings.frames = {1001, 1003};
  const FramePlan plan = plan_frames(still(), nullptr, settings);
  EXPECT_EQ(plan.frames[0].frame, 1001);
  EXPECT_EQ(plan.frames[0].t_video_ns, 20'833'333);
  EXPECT_EQ(plan.frames[1].t_video_ns, 104'166'666);
  EXPECT_FALSE(has_frame(still(), settings, 1000));
  settings.frames = {1000};
  EXPECT_THAT(message_of(still(), nullptr, settings, ErrorKind::usage), HasSubstr("numbered from 1001"));
}

TEST(PlanFrames, GazeBecomesADirectionFromTheEye) {
  const GazeLog log = screen_log();
  const FramePlan plan = plan_frames(still(), &log, paper_settings());
  ASSERT_EQ(plan.frames.size(), 3U);
  const FrameRequest& first = plan.frames[0];
  EXPECT_EQ(first.t_video_ns, 20'833'333);
  // 20.8 ms after the first sample: the sixth, of 20 ms.
  EXPECT_EQ(first.gaze_true.row_before, 7);
  EXPECT_EQ(first.gaze_true.age_ns, 833'333);
  EXPECT_NEAR(first.gaze_true.u, 0.3125, 1e-15);
  ASSERT_TRUE(first.gaze_direction_true.has_value());
  const double angle = std::atan2((0.5 - 0.3125) * 70.848, 60.0);
  EXPECT_NEAR(first.gaze_direction_true->x, -std::sin(angle), 1e-15);
  EXPECT_NEAR(first.gaze_direction_true->y, 0, 1e-15);
  EXPECT_NEAR(length(*first.gaze_direction_true), 1, 1e-15);
  // The pixel that is looked at, in the frame: 0.3125 of 1920.
  EXPECT_NEAR(first.view.pixel(*first.gaze_direction_true).x, 600, 1e-9);
  EXPECT_EQ(first.camera.pose.position_m, (Vec3d{1, 2, 3}));
  EXPECT_THAT(plan.warnings, IsEmpty());
}

TEST(PlanFrames, LatencyChangesTheSteeringGazeOnly) {
  const GazeLog log = screen_log();
  PlanSettings settings = paper_settings();
  settings.gaze_latency_ns = 50 * kMs;
  const FramePlan plan = plan_frames(still(), &log, settings);
  const FrameRequest& second = plan.frames[1];  // at 62.5 ms
  EXPECT_EQ(second.gaze_true.row_before, 2 + 15);
  EXPECT_EQ(second.gaze_render.row_before, 2 + 3);
  EXPECT_EQ(second.gaze_render.t_log_ns + 50 * kMs, second.gaze_true.t_log_ns);
  // Before the log: nothing is known yet.
  EXPECT_EQ(plan.frames[0].gaze_render.row_after, 0);
  EXPECT_EQ(plan.frames[0].gaze_render.state, GazeState::center);
  EXPECT_THAT(plan_as_table(plan), HasSubstr("true gaze"));
}

// Two fixations at 500 Hz, 4 degrees apart, and a saccade of 16 ms between them.
GazeLog jump(std::int64_t begins_ns) {
  GazeLog log = screen_log();
  log.recording_geometry = display_by_name("paper");
  log.samples.clear();
  for (int i = 0; i < 1000; ++i) {
    GazeSample sample;
    sample.t_ns = i * 2 * kMs;
    const double part = std::clamp(static_cast<double>(sample.t_ns - begins_ns) / 16e6, 0.0, 1.0);
    sample.u = 0.4 + 0.07 * (0.5 - 0.5 * std::cos(kPi * part));
    sample.v = 0.5;
    sample.row = i + 2;
    log.samples.push_back(sample);
  }
  return log;
}

TEST(PlanFrames, NoSaccadeFallsBetweenTwoFrames) {
  // Wherever it begins: the frame after it says so, by the log itself, whatever steers.
  PlanSettings settings = paper_settings();
  settings.frames.clear();
  for (int frame = 1; frame <= 40; ++frame) {
    settings.frames.push_back(frame);
  }
  int between = 0;
  for (int k = 0; k < 21; ++k) {
    const std::int64_t begins_ns = 600 * kMs + k * 2 * kMs;
    const GazeLog log = jump(begins_ns);
    const ProcessedGaze still_gaze{jump(10'000 * kMs), {}};
    const FramePlan plan = plan_frames(still(), &log, settings, k % 2 == 0 ? &still_gaze : nullptr);
    int flagged = 0;
    int seen = 0;
    for (const FrameRequest& request : plan.frames) {
      flagged += request.saccade_since_last_frame ? 1 : 0;
      seen += request.eye_in_saccade ? 1 : 0;
      if (request.saccade_since_last_frame) {
        // A frame of 41.7 ms, and what the labels of a saccade may be off by.
        EXPECT_GT(request.t_video_ns, begins_ns - 20 * kMs);
        EXPECT_LT(request.t_video_ns, begins_ns + 16 * kMs + 42 * kMs + 20 * kMs);
      }
      EXPECT_FALSE(request.blink_since_last_frame);
    }
    EXPECT_GE(flagged, 1) << k;
    EXPECT_LE(flagged, 3) << k;
    between += seen == 0 ? 1 : 0;
  }
  EXPECT_GT(between, 0) << "none of them fell between";
}

// A log that loses the eye in the middle of a saccade, for a while or for good, does not say where it is since then.
TEST(PlanFrames, ASaccadeDoesNotLastThroughAGap) {
  PlanSettings settings = paper_settings();
  settings.frames.clear();
  for (int frame = 1; frame <= 72; ++frame) {
    settings.frames.push_back(frame);
  }
  constexpr std::int64_t kEnd_ns = 608 * kMs;  // half of the saccade's time
  for (const std::int64_t seen_again_ns : {1200 * kMs, 10'000 * kMs}) {
    GazeLog log = jump(600 * kMs);
    std::erase_if(log.samples, [&](const GazeSample& s) { return s.t_ns > kEnd_ns && s.t_ns < seen_again_ns; });
    bool went_fast = false;
    for (const FrameRequest& request : plan_frames(still(), &log, settings).frames) {
      went_fast = went_fast || request.saccade_since_last_frame;
      // The rows say nothing of what comes more than 75 ms later, which a gap is bridged for.
      if (request.t_video_ns > kEnd_ns + 75 * kMs && request.t_video_ns < std::min(seen_again_ns, 2000 * kMs)) {
        EXPECT_FALSE(request.eye_in_saccade) << request.frame;
        EXPECT_FALSE(request.saccade_since_last_frame && request.t_video_ns > kEnd_ns + 117 * kMs) << request.frame;
      }
    }
    EXPECT_TRUE(went_fast);
  }
}

TEST(PlanFrames, CameraMustCoverTheFrames) {
  PlanSettings settings = paper_settings();
  EXPECT_EQ(
      message_of(moving(0, 70 * kMs), nullptr, settings, ErrorKind::input),
      "walk.txt: the camera path runs from 0.000 s to 0.070 s, and frame 3 is at 0.104 s; render other frames, or use "
      "`camera-extrapolation` hold");
  EXPECT_EQ(
      message_of(moving(30 * kMs, 60 * kMs), nullptr, settings, ErrorKind::input),
      "walk.txt: the camera path runs from 0.030 s to 0.060 s, and frame 1 is at 0.021 s (3 of 3 frames are outside); "
      "render other frames, or use `camera-extrapolation` hold");
  settings.camera_extrapolation = CameraExtrapolation::hold;
  const FramePlan plan = plan_frames(moving(30 * kMs, 70 * kMs), nullptr, settings);
  EXPECT_EQ(plan.frames[0].camera.pose.position_m.x, 30e6);
  EXPECT_EQ(plan.frames[1].camera.pose.position_m.x, 62.5e6);
  EXPECT_EQ(plan.frames[2].camera.pose.position_m.x, 70e6);
  ASSERT_EQ(plan.warnings.size(), 1U);
  EXPECT_THAT(plan.warnings[0], HasSubstr("its first or last pose is held"));
  settings.camera_extrapolation = CameraExtrapolation::error;
  EXPECT_NO_THROW(plan_frames(moving(20'833'333, 104'166'666), nullptr, settings));
  EXPECT_THROW(plan_frames(moving(20'833'334, 104'166'666), nullptr, settings), Error);
}

TEST(PlanFrames, ScreenGazeNeedsTheScreensGeometry) {
  const GazeLog log = screen_log();
  PlanSettings settings = paper_settings();
  const std::string remedy = "; give `screen` NAME, or `screen-px` W,H `screen-cm` W,H `screen-distance-cm` D";
  settings.display.reset();
  EXPECT_EQ(message_of(still(), &log, settings, ErrorKind::input),
            "gaze.csv: gaze on a screen cannot be turned into angles without the screen's size and distance" + remedy);
  settings.display = display_by_name("paper");
  settings.display->distance_cm = 0;
  EXPECT_EQ(message_of(still(), &log, settings, ErrorKind::input),
            "gaze.csv: gaze on a screen cannot be turned into angles: the display's distance from the eye in cm is "
            "not stated; give `screen-distance-cm`" +
                remedy);
}

TEST(PlanFrames, DirectionsUseTheCamerasOwnView) {
  GazeLog log = screen_log();
  log.kind = GazeKind::direction;
  for (GazeSample& sample : log.samples) {
    sample.direction = normalize(Vec3d{0.1, 0.2, -1});
  }
  PlanSettings settings = paper_settings();
  settings.display.reset();
  CameraPath camera = still();
  camera.projection.yfov_rad = 90 * kRadPerDeg;
  const FramePlan plan = plan_frames(camera, &log, settings);
  const Vec2d pixel = plan.frames[0].view.pixel(*plan.frames[0].gaze_direction_render);
  EXPECT_NEAR(pixel.x, 960 + 0.1 * 540, 1e-9);  // 540 px are one unit at 90 degrees
  EXPECT_NEAR(pixel.y, 540 - 0.2 * 540, 1e-9);
  EXPECT_THAT(plan_as_table(plan), HasSubstr("gaze x y z"));
  camera.projection.middle_m = {0.1, 0.2};  // a lens that is shifted so far that the eye looks at the middle
  const FramePlan shifted = plan_frames(camera, &log, settings);
  const Vec2d middle = shifted.frames[0].view.pixel(*shifted.frames[0].gaze_direction_render);
  EXPECT_NEAR(middle.x, 960, 1e-9);
  EXPECT_NEAR(middle.y, 540, 1e-9);
  EXPECT_NEAR(shifted.frames[0].camera.middle_px.x, 54, 1e-9);
  EXPECT_NEAR(shifted.frames[0].camera.middle_px.y, -108, 1e-9);
  settings.display = display_by_name("paper");
  EXPECT_THAT(plan_frames(camera, &log, settings).warnings,
              ElementsAre("gaze.csv: gaze directions need no display; the given one is not used"));
  camera.projection.kind = ProjectionKind::orthographic;
  EXPECT_EQ(
      message_of(camera, &log, settings, ErrorKind::input),
      "gaze.csv: gaze directions need a perspective camera: an orthographic one has no eye; use a perspective camera, "
      "or a log of gaze on a screen");
}

TEST(PlanFrames, PoliciesForFramesWithoutGaze) {
  const GazeLog log = screen_log();
  PlanSettings settings = paper_settings();
  settings.frames = {40};  // 1.6 s after the start; the log ends after 0.16 s
  settings.gaze.no_gaze = NoGazePolicy::uniform;
  FramePlan plan = plan_frames(still(), &log, settings);
  EXPECT_FALSE(plan.frames[0].gaze_direction_render.has_value());
  EXPECT_EQ(plan.frames[0].gaze_render.state, GazeState::none);
  // The center is that of the frame, wherever it lies on the display.
  settings.gaze.no_gaze = NoGazePolicy::center;
  settings.frame_rect = {1920, 1080, 1920, 1080};
  plan = plan_frames(still(), &log, settings);
  EXPECT_EQ(plan.frames[0].gaze_render.state, GazeState::center);
  EXPECT_NEAR(plan.frames[0].gaze_render.u, 0.75, 1e-12);
  EXPECT_NEAR(plan.frames[0].gaze_render.v, 0.75, 1e-12);
  const Vec2d pixel = plan.frames[0].view.pixel(*plan.frames[0].gaze_direction_render);
  EXPECT_NEAR(pixel.x, 960, 1e-9);
  EXPECT_NEAR(pixel.y, 540, 1e-9);
  settings.gaze.no_gaze = NoGazePolicy::error;
  EXPECT_THAT(message_of(still(), &log, settings, ErrorKind::input), HasSubstr("gaze.csv: no gaze at log time"));
}

TEST(PlanFrames, RecordingAndViewingGeometryAreCompared) {
  GazeLog log = screen_log();
  log.recording_geometry = display_by_name("tx300");
  PlanSettings chosen = paper_settings();
  chosen.transfer = GazeTransfer::fraction;
  const FramePlan plan = plan_frames(still(), &log, chosen);
  ASSERT_EQ(plan.warnings.size(), 1U);
  // (70.848 / 60) / (50.9174 / 65) = 1.5074
  EXPECT_EQ(plan.warnings[0],
            "gaze.csv: recorded on a display 42.8 deg wide and shown on one 61.1 deg wide; gaze is carried over as a "
            "fraction "
            "of the display, so angles near its center change by a factor of 1.51");
  PlanSettings settings = paper_settings();
  settings.display->height_cm *= 1.22;
  EXPECT_THAT(plan_frames(still(), nullptr, settings).warnings,
              ElementsAre("the display's pixels are not square: height to width 1.220"));
}

TEST(PlanFrames, SettingsThatCannotBe) {
  PlanSettings settings = paper_settings();
  settings.frames.clear();
  EXPECT_EQ(message_of(still(), nullptr, settings, ErrorKind::usage), "there is no frame to render; give `frames`");
  settings.frames = {0};
  EXPECT_EQ(message_of(still(), nullptr, settings, ErrorKind::usage),
            "`frames`: frame 0 does not exist: frames are numbered from 1; name others, or change `first-frame`");
  settings.frames = {1};
  settings.gaze_latency_ns = -1;
  EXPECT_THAT(message_of(still(), nullptr, settings, ErrorKind::usage), HasSubstr("would look ahead"));
  settings.gaze_latency_ns = 0;
  settings.fps = {0, 1};
  EXPECT_THAT(message_of(still(), nullptr, settings, ErrorKind::usage), HasSubstr("a frame rate of 0 is not positive"));
  settings.fps = {1, 1'000'000'000'000};
  settings.frames = {2147483647};
  EXPECT_EQ(message_of(still(), nullptr, settings, ErrorKind::usage),
            "frame 2147483647 lies beyond int64 nanoseconds; check `frames`, `fps` and `start`");
}

TEST(PrintPlan, TableIsAligned) {
  const GazeLog log = screen_log();
  PlanSettings settings = paper_settings();
  settings.frames = {1, 20};
  settings.gaze.max_age_ns = 300 * kMs;
  settings.gaze.no_gaze = NoGazePolicy::uniform;
  EXPECT_EQ(plan_as_table(plan_frames(still(), &log, settings)),
            "frame    time s         position m       gaze u v  state     rows  age ms  valid  event  reason\n"
            "    1  0.020833  1.000 2.000 3.000  0.3125 0.5000  measured     7   0.833  ok     -      hold: row 7\n"
            "   20  0.812500  1.000 2.000 3.000              -  none         -       -  -      -      no gaze (656 ms "
            "after the log's last "
            "row, last usable row 41 is 656 ms old (limit 300 ms)): uniform\n");
}

TEST(PrintPlan, JsonHoldsExactTimesAndUnits) {
  const GazeLog log = screen_log();
  PlanSettings settings = paper_settings();
  settings.frames = {1};
  settings.gaze.event_ns = 4'999'999'999;
  const auto json = nlohmann::json::parse(plan_as_json(plan_frames(still(), &log, settings)));
  const auto& frame = json.at("frames").at(0);
  EXPECT_EQ(frame.at("frame"), 1);
  EXPECT_EQ(frame.at("t_video_ns").get<std::int64_t>(), 20'833'333);
  EXPECT_EQ(frame.at("gaze_true").at("t_log_ns").get<std::int64_t>(), 5'020'833'332);
  EXPECT_EQ(frame.at("gaze_render").at("row_before"), 7);
  EXPECT_TRUE(frame.at("gaze_render").at("row_after").is_null());
  EXPECT_EQ(frame.at("gaze_render").at("age_ns"), 833'332);
  EXPECT_EQ(frame.at("gaze_render").at("state"), "measured");
  EXPECT_EQ(frame.at("camera").at("position_m"), (std::vector<double>{1, 2, 3}));
  const auto none = nlohmann::json::parse(plan_as_json(plan_frames(still(), nullptr, settings)));
  EXPECT_TRUE(none.at("frames").at(0).at("gaze_render").at("direction").is_null());
  EXPECT_EQ(none.at("frames").at(0).at("gaze_render").at("reason"), "no gaze log");
}

}  // namespace
}  // namespace gazetrace::plan_frames_test
