// SPDX-License-Identifier: Apache-2.0
// Two clocks by anchors, and what the plan tells of latency and processing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "gazetrace/foveation.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace::gaze_clock_test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

TEST(GazeClock, OneAnchorIsAnOffset) {
  const ClockFit fit = fit_clock({{1'700'000'000'000'000'123, 2'000 * kMs}});
  EXPECT_EQ(fit.scale, 1);
  EXPECT_EQ(fit.event_ns, 1'700'000'000'000'000'123);
  EXPECT_EQ(fit.offset_ns, 2'000 * kMs);
  EXPECT_EQ(fit.max_residual_ns, 0);
}

TEST(GazeClock, AnchorsOfADriftingClockGiveItsDrift) {
  // 50 ppm, far from zero.
  const std::int64_t begin = 1'700'000'000'000'000'000;
  std::vector<ClockAnchor> anchors;
  for (std::int64_t s = 0; s <= 600; s += 100) {
    anchors.push_back({begin + s * 1'000'000'000, 5'000 * kMs + s * 1'000'050'000});
  }
  const ClockFit fit = fit_clock(anchors);
  EXPECT_NEAR(fit.scale, 1.00005, 1e-12);
  EXPECT_EQ(fit.offset_ns, 5'000 * kMs);
  EXPECT_LT(fit.max_residual_ns, 1);
}

// By hand: x = 0, 1, 2 s and y = 0, 1.1, 2 s: slope 1, intercept 0.1/3, residuals -1/30, 2/30, -1/30.
TEST(GazeClock, ResidualsAreThoseOfLeastSquares) {
  const ClockFit fit = fit_clock({{0, 0}, {1000 * kMs, 1100 * kMs}, {2000 * kMs, 2000 * kMs}});
  EXPECT_NEAR(fit.scale, 1, 1e-15);
  EXPECT_NEAR(static_cast<double>(fit.offset_ns), 1e8 / 3, 1);
  EXPECT_NEAR(fit.max_residual_ns, 2e9 / 30, 1);
  EXPECT_NEAR(fit.rms_residual_ns, std::sqrt(6.0 / 3) * 1e9 / 30, 1);
}

TEST(GazeClock, ImpossibleAnchorsAreRefused) {
  EXPECT_THROW(fit_clock({{5, 0}, {5, 10}}), Error);
  EXPECT_THROW(fit_clock({{0, 10}, {10, 0}}), Error);
  EXPECT_THROW(fit_clock({}), Error);
}

TEST(GazeClock, TimesBeyondInt64AreRefused) {
  // x = 0, -1, -2 s and y = 0, 0, -3 s: slope 1.5, and the line passes 0.5 s above the first anchor, the last time.
  const std::int64_t last = std::numeric_limits<std::int64_t>::max();
  EXPECT_THROW(fit_clock({{0, last}, {-1000 * kMs, last}, {-2000 * kMs, last - 3000 * kMs}}), Error);
  EXPECT_EQ(fit_clock({{0, last}}).offset_ns, last);
  GazeLog log;
  GazeMapping mapping;
  mapping.event_ns = 0;
  for (const double scale : {1e11, 2e20, 1e30, 1.1e38, 1e300}) {
    mapping.scale = scale;
    for (const std::int64_t t : {std::int64_t{3}, std::int64_t{-3}, 1'000 * kMs, -1'000 * kMs, last, -last}) {
      if (static_cast<double>(t) * scale > 0x1p63 || static_cast<double>(t) * scale < -0x1p63) {
        EXPECT_THROW(video_time_ns(log, mapping, t), Error) << scale << " " << t;
      }
    }
  }
  // What exceeds int64 by itself and not with its offset is a time.
  mapping.scale = 2;
  mapping.offset_ns = -last;
  const std::int64_t half = 5'000'000'000'000'000'000;
  EXPECT_EQ(video_time_ns(log, mapping, half), half - last + half);
}

TEST(GazeClock, MessagesAreFoundByTheirText) {
  GazeLog log;
  log.source = "log.asc";
  log.events = {{GazeEventType::message, Eye::cyclopean, 5, 5, "TRIAL 1", 10},
                {GazeEventType::message, Eye::cyclopean, 7, 7, "TRIAL 10", 11},
                {GazeEventType::message, Eye::cyclopean, 9, 9, "SYNC now", 12}};
  EXPECT_EQ(time_of_message(log, "TRIAL 1"), 5);
  EXPECT_EQ(time_of_message(log, "SYNC"), 9);
  const auto message = [&](const char* text) -> std::string {
    try {
      time_of_message(log, text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("TRIAL"), HasSubstr("has 2 messages with 'TRIAL', the first two in lines 10 and 11"));
  EXPECT_THAT(message("nothing"), HasSubstr("has no message 'nothing'"));
}

CameraPath still() {
  return static_camera(look_at({1, 2, 3}, {1, 2, 0}, {0, 1, 0}), {});
}

PlanSettings second_at(std::int64_t fps) {
  PlanSettings settings;
  settings.fps = {fps, 1};
  settings.display = DisplayGeometry{1920, 1080, 50.9174, 28.6411, 65, 0, 0};
  for (std::int32_t i = 1; i <= fps; ++i) {
    settings.frames.push_back(i + static_cast<std::int32_t>(fps));
  }
  return settings;
}

TEST(GazeAges, AreLatencyPlusTheWaitForTheFrame) {
  SynthSettings synthetic;
  synthetic.rate_hz = 100;
  const GazeLog log = synthesize_gaze(synthetic).log;
  PlanSettings settings = second_at(25);
  settings.gaze_latency_ns = 50 * kMs;
  const FramePlan plan = plan_frames(still(), &log, settings);
  ASSERT_TRUE(plan.ages.has_value());
  EXPECT_EQ(plan.ages->frames, 25U);
  // Samples every 10 ms, frames at 20 + 40 k ms: each finds a sample of its own instant, 50 ms ago.
  EXPECT_NEAR(plan.ages->min_ns, 50e6, 1);
  EXPECT_NEAR(plan.ages->max_ns, 50e6, 1);
  EXPECT_NEAR(plan.ages->half_frame_ns, 20e6, 1e-6);
  EXPECT_THAT(plan_as_table(plan), HasSubstr("effective age at mid-display: 50.0 ms in all of"));
  // Half way between samples the wait is 5 ms.
  settings.gaze.offset_ns = 5 * kMs;
  const FramePlan later = plan_frames(still(), &log, settings);
  EXPECT_NEAR(later.ages->median_ns, 55e6, 1);
  EXPECT_NEAR(later.ages->mean_ns, 55e6, 1);
}

TEST(GazeAges, FramesWithoutGazeAreLeftOut) {
  SynthSettings synthetic;
  synthetic.rate_hz = 100;
  const GazeLog log = synthesize_gaze(synthetic).log;
  PlanSettings settings = second_at(25);
  settings.gaze_latency_ns = 50 * kMs;
  settings.gaze.offset_ns = 1100 * kMs;  // frames at 1020 + 40 k ms: 4 begin to see gaze before the log has any
  const FramePlan plan = plan_frames(still(), &log, settings);
  EXPECT_EQ(plan.ages->without, 4U);
  EXPECT_EQ(plan.ages->frames, 21U);
  EXPECT_NEAR(plan.ages->min_ns, 50e6, 1);
  EXPECT_NEAR(plan.ages->max_ns, 50e6, 1);
  EXPECT_FALSE(plan.frames[3].gaze_effective_age_ns.has_value());
  EXPECT_EQ(plan.frames[4].gaze_effective_age_ns, 50 * kMs);
  EXPECT_THAT(plan_as_table(plan), HasSubstr("4 frames without gaze are left out"));
}

TEST(GazeAges, SlowFramesAreWarnedAbout) {
  const GazeLog log = synthesize_gaze({}).log;
  PlanSettings settings = second_at(24);
  settings.gaze_latency_ns = 50 * kMs;
  const FramePlan plan = plan_frames(still(), &log, settings);
  ASSERT_EQ(plan.warnings.size(), 1U);
  EXPECT_THAT(plan.warnings[0],
              HasSubstr("a latency of 50 ms is 1.2 frames at 24 fps: while a frame is shown, the age of "
                        "its gaze grows from 29.2 to 70.8 ms; a study of latency needs `fps` 80 or more"));
  PlanSettings fast = second_at(90);
  fast.gaze_latency_ns = 50 * kMs;
  EXPECT_TRUE(plan_frames(still(), &log, fast).warnings.empty());
  settings.gaze_latency_ns = 0;
  EXPECT_TRUE(plan_frames(still(), &log, settings).warnings.empty());
}

TEST(GazeAges, OfAFrameLogAreUnknown) {
  GazeLog log = synthesize_gaze({}).log;
  log.sample_age_unknown = true;
  PlanSettings settings = second_at(25);
  settings.gaze_latency_ns = 200 * kMs;
  const FramePlan plan = plan_frames(still(), &log, settings);
  EXPECT_EQ(plan.ages->frames, 0U);
  EXPECT_EQ(plan.ages->unknown, 25U);
  EXPECT_THAT(plan_as_table(plan), HasSubstr("unknown"));
  const auto json = nlohmann::json::parse(plan_as_json(plan));
  EXPECT_TRUE(json.at("frames").at(0).at("gaze_render").at("age_ns").is_null());
}

TEST(PlanProcessing, ChangesTheSteeringGazeOnly) {
  const GazeLog log = synthesize_gaze({}).log;
  const ProcessedGaze off = process_gaze(log, {parse_gaze_step("offset:x=3")});
  const FramePlan clean = plan_frames(still(), &log, second_at(25));
  const FramePlan plan = plan_frames(still(), &log, second_at(25), &off);
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    EXPECT_EQ(plan.frames[i].gaze_true.u, clean.frames[i].gaze_true.u);
    EXPECT_NEAR(
        angle_between_rad(*plan.frames[i].gaze_direction_render, *plan.frames[i].gaze_direction_true) * kDegPerRad, 3,
        1e-9);
  }
  EXPECT_THAT(plan_as_table(plan), HasSubstr("gaze_render: offset:x=3deg,y=0deg"));
  EXPECT_THAT(plan_as_table(plan), HasSubstr("true gaze"));
}

TEST(PlanProcessing, ALostFirstSampleDoesNotShiftTheClock) {
  const GazeLog log = synthesize_gaze({}).log;
  ProcessedGaze cut{log, {}, false};
  cut.log.samples.erase(cut.log.samples.begin(), cut.log.samples.begin() + 10);
  const FramePlan plan = plan_frames(still(), &log, second_at(25), &cut);
  EXPECT_EQ(plan.frames[0].gaze_render.t_log_ns, plan.frames[0].gaze_true.t_log_ns);
}

TEST(PlanEvents, FramesSayWhatTheEyeDoes) {
  SynthSettings synthetic;
  synthetic.drift_deg = 0;
  const SynthGaze synth = synthesize_gaze(synthetic);
  PlanSettings settings = second_at(100);
  const FramePlan plan = plan_frames(still(), &synth.log, settings);
  std::size_t saccades = 0;
  for (const FrameRequest& request : plan.frames) {
    ASSERT_TRUE(request.gaze_true.movement.has_value());
    // 500 Hz: sample 2 t.
    const auto sample = static_cast<std::size_t>(request.gaze_true.t_log_ns / 2'000'000);
    if (synth.truth.labels[sample] == EyeMovement::saccade) {
      ++saccades;
      EXPECT_EQ(*request.gaze_true.movement, EyeMovement::saccade);
    }
  }
  EXPECT_GT(saccades, 3U);
  settings.find_events = false;
  EXPECT_FALSE(plan_frames(still(), &synth.log, settings).frames[0].gaze_true.movement.has_value());
}

TEST(PlanEvents, InterpolationJumpsOverASaccade) {
  // 20 Hz: a saccade of 10 deg between two samples.
  GazeLog log;
  log.source = "slow.csv";
  log.recording_geometry = DisplayGeometry{1000, 1000, 100, 100, 100, 0, 0};
  for (std::int64_t i = 0; i < 40; ++i) {
    GazeSample sample;
    sample.t_ns = i * 50 * kMs;
    sample.row = i + 1;
    sample.u = i < 20 ? 0.4 : 0.6;
    sample.v = 0.5;
    log.samples.push_back(sample);
  }
  GazeMapping mapping;
  mapping.interpolation = GazeInterpolation::linear;
  const std::vector<EyeMovement> movements = detect_events(log, event_preset("ivt")).labels;
  for (const std::int64_t t_ms : {955, 970, 980, 995}) {
    const GazeAtTime gaze = gaze_at(log, mapping, t_ms * kMs, &movements);
    EXPECT_EQ(gaze.u, t_ms <= 975 ? 0.4 : 0.6) << t_ms;
    EXPECT_THAT(gaze.reason, HasSubstr("not within a fixation"));
  }
  EXPECT_NEAR(gaze_at(log, mapping, 975 * kMs).u, 0.5, 1e-12);  // where nobody knows what the eye does
}

}  // namespace
}  // namespace gazetrace::gaze_clock_test
