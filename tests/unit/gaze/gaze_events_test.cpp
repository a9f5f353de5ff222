// SPDX-License-Identifier: Apache-2.0
// Event detection: hand-made logs with exact answers, synthetic ones with known truth, and what must not matter.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "support/event_scores.hpp"

namespace gazetrace::gaze_events_test {
namespace {

// Directions at 100 Hz: azimuth by sample number, degrees; NaN is lost.
GazeLog azimuths(const std::vector<double>& azimuth_deg) {
  GazeLog log;
  log.kind = GazeKind::direction;
  log.source = "hand.csv";
  for (std::size_t i = 0; i < azimuth_deg.size(); ++i) {
    GazeSample sample;
    sample.t_ns = static_cast<std::int64_t>(i) * 10'000'000;
    sample.row = static_cast<std::int64_t>(i) + 1;
    const double a = azimuth_deg[i] * kRadPerDeg;
    sample.direction = {std::sin(a), 0, -std::cos(a)};
    sample.validity = std::isnan(a) ? GazeValidity::lost : GazeValidity::ok;
    log.samples.push_back(sample);
  }
  return log;
}

void append(std::vector<double>& to, std::size_t count, double value) {
  to.insert(to.end(), count, value);
}

std::string summary(const EyeEvents& events) {
  std::string text;
  for (const EyeEvent& event : events.events) {
    text += std::string(to_string(event.movement)).substr(0, 1) + std::to_string(event.first) + "-" +
            std::to_string(event.last) + " ";
  }
  return text;
}

EventSettings plain_ivt() {
  EventSettings settings;
  settings.merge_gap_ns = 0;
  settings.max_gap_ns = 0;
  settings.min_fixation_ns = 0;
  settings.max_blink_ns = settings.min_blink_ns = 0;
  return settings;
}

const double kLost = std::nan("");

TEST(GazeEvents, VelocityIsTheAngleOverTheWindow) {
  // 0.2 deg a sample is 20 deg/s; window of 20 ms: one sample to either side.
  std::vector<double> a;
  for (int i = 0; i < 10; ++i) {
    a.push_back(0.2 * i);
  }
  const GazeDirections gaze = gaze_directions(azimuths(a));
  for (const double speed : angular_speed_deg_s(gaze, 20'000'000)) {
    EXPECT_NEAR(speed, 20.0, 1e-9);
  }
}

TEST(GazeEvents, IvtSplitsAtTheThreshold) {
  std::vector<double> a;
  append(a, 20, 0);
  append(a, 20, 4);
  // The step is seen from the sample before it and the one after it: 4 deg in 20 ms.
  const EyeEvents events = detect_events(azimuths(a), plain_ivt());
  EXPECT_EQ(summary(events), "f0-18 s19-20 f21-39 ");
  EXPECT_NEAR(events.events[1].amplitude_deg, 4, 1e-12);
  EXPECT_NEAR(events.events[1].peak_velocity_deg_s, 200, 1e-9);
  EXPECT_NEAR(events.events[1].angle_deg, 0, 1e-9);
  EXPECT_NEAR(events.events[2].direction.x, std::sin(4 * kRadPerDeg), 1e-12);
  EventSettings blunt = plain_ivt();
  blunt.velocity_deg_s = 201;
  EXPECT_EQ(summary(detect_events(azimuths(a), blunt)), "f0-39 ");
}

TEST(GazeEvents, IvtBridgesShortGapsOnly) {
  std::vector<double> a;
  append(a, 20, 0);
  append(a, 6, kLost);  // 70 ms between the seen samples
  append(a, 20, 0);
  append(a, 7, kLost);  // 80 ms
  append(a, 20, 0);
  EventSettings settings = plain_ivt();
  EXPECT_EQ(summary(detect_events(azimuths(a), settings)), "f0-19 l20-25 f26-45 l46-52 f53-72 ");
  settings.max_gap_ns = 75'000'000;
  EXPECT_EQ(summary(detect_events(azimuths(a), settings)), "f0-45 l46-52 f53-72 ");
  // A loss that the log calls a blink is never bridged.
  GazeLog log = azimuths(a);
  log.samples[22].validity = GazeValidity::blink;
  EXPECT_EQ(summary(detect_events(log, settings)), "f0-19 l20-21 b22-22 l23-25 f26-45 l46-52 f53-72 ");
}

TEST(GazeEvents, IvtMergesNeighboursAndDropsTheShort) {
  std::vector<double> a;
  append(a, 20, 0);
  append(a, 1, 3);  // a spike: samples 19 and 21 see it, 20 itself is between equals
  append(a, 20, 0.2);
  EventSettings settings = plain_ivt();
  EXPECT_EQ(summary(detect_events(azimuths(a), settings)), "f0-18 s19-19 f20-20 s21-21 f22-40 ");
  settings.merge_gap_ns = 75'000'000;
  settings.merge_angle_deg = 0.5;
  settings.min_fixation_ns = 60'000'000;
  // The spike's own sample is 3 deg away and joins neither; it goes as too short.
  EXPECT_EQ(summary(detect_events(azimuths(a), settings)), "f0-18 s19-19 u20-20 s21-21 f22-40 ");
  std::vector<double> b;
  append(b, 20, 0);
  append(b, 1, 1.5);
  append(b, 1, -1.5);
  append(b, 20, 0.2);
  EXPECT_EQ(summary(detect_events(azimuths(b), settings)), "f0-41 ");
  settings.merge_angle_deg = 0.1;
  EXPECT_EQ(summary(detect_events(azimuths(b), settings)), "f0-18 s19-22 f23-41 ");
  // Away and back within 120 ms: too long for a pause of one fixation.
  settings.merge_angle_deg = 0.5;
  std::vector<double> c;
  append(c, 20, 0);
  c.insert(c.end(), {2, 4, 6, 8, 10, 7, 5, 3, 1});
  append(c, 20, 0.2);
  EXPECT_EQ(summary(detect_events(azimuths(c), settings)), "f0-18 s19-29 f30-48 ");
  settings.merge_gap_ns = 130'000'000;
  EXPECT_EQ(summary(detect_events(azimuths(c), settings)), "f0-48 ");
}

// Rows that a logger dropped are a break of the clock where the step over them exceeds 75 ms, even if fixations further
// apart than that are merged.
TEST(GazeEvents, IvtDoesNotMergeAcrossDroppedRows) {
  EventSettings settings = plain_ivt();
  settings.merge_gap_ns = 100'000'000;
  settings.merge_angle_deg = 3;
  const auto without_seven_rows = [](const std::vector<double>& a, std::size_t first, std::int64_t step_ns) {
    GazeLog log = azimuths(a);
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      log.samples[i].t_ns = static_cast<std::int64_t>(i) * step_ns;
    }
    const auto begin = log.samples.begin() + static_cast<std::ptrdiff_t>(first);
    log.samples.erase(begin, begin + 7);
    return log;
  };
  // 90 Hz, at rest: the step over the missing rows is 89 ms.
  const std::vector<double> rest(60, 0.0);
  EXPECT_EQ(summary(detect_events(without_seven_rows(rest, 20, 11'111'111), settings)), "f0-19 f20-52 ");
  // 100 Hz, a jump after 80 ms: the fixations around both are 100 ms apart.
  std::vector<double> jump(60, 0.0);
  jump[27] = 2;
  EXPECT_EQ(summary(detect_events(without_seven_rows(jump, 20, 10'000'000), settings)), "f0-19 s20-21 f22-52 ");
  // Without the missing rows the same jump is merged.
  EXPECT_EQ(summary(detect_events(azimuths(jump), settings)), "f0-59 ");
}

// As in Tobii Studio's exports: eight samples of 120 Hz are a fixation of 67 ms.
TEST(GazeEvents, AFixationLastsAStepForEachSample) {
  EventSettings settings = plain_ivt();
  settings.min_fixation_ns = 60'000'000;
  for (const auto& [count, expected] :
       {std::pair(7U, "f0-18 s19-20 u21-25 s26-27 f28-46 "), std::pair(8U, "f0-18 s19-20 f21-26 s27-28 f29-47 ")}) {
    std::vector<double> a;
    append(a, 20, 0);
    append(a, count, 4);  // of these the first and the last are faster
    append(a, 20, 0);
    EXPECT_EQ(summary(detect_events(azimuths(a), settings)), expected);
  }
}

// A tracker that bridged a gap says one fixation; a blink within it is still one.
TEST(GazeEvents, OfTheLogGoOnWhereSamplesAreLost) {
  std::vector<double> a;
  append(a, 10, 0);
  append(a, 3, kLost);
  append(a, 10, 0);
  GazeLog log = azimuths(a);
  log.events = {{GazeEventType::fixation, Eye::cyclopean, 20'000'000, 200'000'000, {}, 0}};
  EXPECT_EQ(summary(events_of_log(log)), "u0-1 f2-20 u21-22 ");
  log.samples[11].validity = GazeValidity::blink;
  EXPECT_EQ(summary(events_of_log(log)), "u0-1 f2-10 b11-11 f12-20 u21-22 ");
}

TEST(GazeEvents, IdtIsTheDispersionOfTheWindow) {
  EventSettings settings = plain_ivt();
  settings.method = "idt";
  settings.min_fixation_ns = 100'000'000;
  std::vector<double> a;
  append(a, 15, 0);
  append(a, 15, 0.99);  // within 1 deg of the first half
  append(a, 15, 1.01);  // beyond it
  EXPECT_EQ(summary(detect_events(azimuths(a), settings)), "f0-29 f30-44 ");
  std::vector<double> b;
  append(b, 15, 0);
  append(b, 5, 5);  // too short to be one
  append(b, 15, 9);
  EXPECT_EQ(summary(detect_events(azimuths(b), settings)), "f0-14 s15-19 f20-34 ");
  // Ten samples last 90 ms, eleven 100.
  std::vector<double> c;
  append(c, 10, 0);
  append(c, 11, 5);
  EXPECT_EQ(summary(detect_events(azimuths(c), settings)), "s0-9 f10-20 ");
}

TEST(GazeEvents, LossesOfABlinksLengthAreBlinks) {
  std::vector<double> a;
  append(a, 20, 0);
  append(a, 10, kLost);  // 110 ms
  append(a, 20, 0);
  append(a, 60, kLost);  // 610 ms
  append(a, 20, 0);
  EventSettings settings = plain_ivt();
  settings.min_blink_ns = 50'000'000;
  settings.max_blink_ns = 500'000'000;
  EXPECT_EQ(summary(detect_events(azimuths(a), settings)), "f0-19 b20-29 f30-49 l50-109 f110-129 ");
}

TEST(GazeEvents, AJumpOfTheClockEndsAnEvent) {
  GazeLog log = azimuths(std::vector<double>(40, 0.0));
  for (std::size_t i = 20; i < 40; ++i) {
    log.samples[i].t_ns += 3'000'000'000;
  }
  EXPECT_EQ(summary(detect_events(log, event_preset("ivt-attention"))), "f0-19 f20-39 ");
}

TEST(GazeEvents, TheHeadsOwnMotionIsNoEyeMovementInTheWorld) {
  // The head turns left at 40 deg/s while the eye stays on a point in the world.
  std::vector<double> a;
  GazeLog log;
  for (int i = 0; i < 100; ++i) {
    a.push_back(0.4 * i);
  }
  log = azimuths(a);
  for (std::size_t i = 0; i < 100; ++i) {
    const double half = 0.5 * 0.4 * static_cast<double>(i) * kRadPerDeg;
    log.head.push_back({log.samples[i].t_ns, {}, {0, std::sin(half), 0, std::cos(half)}});
  }
  EXPECT_EQ(summary(detect_events(log, event_preset("ivt-hmd"))), "f0-99 ");
  EXPECT_EQ(summary(detect_events(log, event_preset("idt-hmd"))), "f0-99 ");
  // In the head the eye turns, below the attention filter's 100 deg/s and above 30.
  EXPECT_EQ(summary(detect_events(log, event_preset("ivt-attention"))), "f0-99 ");
  EXPECT_EQ(summary(detect_events(log, plain_ivt())), "s0-99 ");
  // The wrong sign of the head's turn doubles the motion.
  for (HeadPose& pose : log.head) {
    pose.orientation.y = -pose.orientation.y;
  }
  EXPECT_EQ(summary(detect_events(log, event_preset("ivt-hmd"))), "s0-99 ");
}

TEST(GazeEvents, WhereTheWorldsNorthIsDoesNotMatter) {
  SynthSettings synthetic;
  synthetic.kind = GazeKind::direction;
  synthetic.noise_deg = 0.1;
  GazeLog log = synthesize_gaze(synthetic).log;
  for (const char* const name : {"ivt-hmd", "idt-hmd", "adaptive-hmd"}) {
    log.head = {{0, {}, {0, 0, 0, 1}}};
    const EyeEvents straight = detect_events(log, event_preset(name));
    // Looking backwards, where azimuth wraps, and tilted up by 60 degrees: not for I-DT, whose extents are along level
    // axes.
    const Quatd tilt = std::string(name) == "idt-hmd" ? Quatd{} : Quatd{0.5, 0, 0, std::sqrt(0.75)};
    log.head = {{0, {}, normalize(Quatd{0, 1, 0, 0.1} * tilt)}};
    EXPECT_EQ(detect_events(log, event_preset(name)).labels, straight.labels) << name;
  }
}

TEST(GazeEvents, PresetsOfOneDeviceRefuseTheOther) {
  const GazeLog head = azimuths(std::vector<double>(20, 0.0));
  const auto message = [&](const char* preset) -> std::string {
    try {
      detect_events(head, event_preset(preset));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("ivt").find("'ivt' is for desktop data; use ivt-hmd, ivt-attention"), std::string::npos);
  EXPECT_NE(message("ivt-hmd").find("needs the head's pose"), std::string::npos);
  EXPECT_EQ(message("ivt-attention"), "");
  EXPECT_NO_THROW(detect_events(head, event_preset("ivt"), GazeDevice::desktop));
  EXPECT_THROW(event_preset("ivd"), Error);
  GazeLog screen;
  screen.samples.resize(3);
  EXPECT_THROW(detect_events(screen, event_preset("ivt")), Error);  // no size, no distance: no angles
}

struct TruthCase {
  const char* preset;
  double rate_hz, noise_deg;
  double fixation_f1, saccade_f1;  // at least
};

// What each method reaches on 60 s of synthetic gaze. A window of 20 ms widens saccades by as much, which at 1 to 2 deg
// is as long as they are. I-DT gives the ends of a saccade to the fixations beside it: what it leaves over is no
// saccade.
TEST(GazeEvents, RecoversSyntheticTruth) {
  const TruthCase cases[] = {
      {"ivt", 1000, 0.0, 0.99, 0.9}, {"ivt", 500, 0.05, 0.99, 0.9},       {"ivt", 120, 0.1, 0.97, 0.5},
      {"idt", 500, 0.05, 0.95, 0.0}, {"adaptive", 1000, 0.05, 0.97, 0.9}, {"adaptive", 500, 0.05, 0.97, 0.9},
  };
  for (const TruthCase& c : cases) {
    SynthSettings settings;
    settings.duration_ns = 60'000'000'000;
    settings.rate_hz = c.rate_hz;
    settings.noise_deg = c.noise_deg;
    settings.seed = 7;
    settings.blinks_per_min = 20;
    const SynthGaze synth = synthesize_gaze(settings);
    const EyeEvents events = detect_events(synth.log, event_preset(c.preset));
    const auto f1 = [&](EyeMovement m) { return score_events(synth.truth.events, events.events, m).f1(); };
    std::printf("%-9s %6.0f Hz %.2f deg: F1 fixation %.3f saccade %.3f blink %.3f\n", c.preset, c.rate_hz, c.noise_deg,
                f1(EyeMovement::fixation), f1(EyeMovement::saccade), f1(EyeMovement::blink));
    EXPECT_GE(f1(EyeMovement::fixation), c.fixation_f1) << c.preset;
    EXPECT_GE(f1(EyeMovement::saccade), c.saccade_f1) << c.preset;
    EXPECT_GE(f1(EyeMovement::blink), 0.99) << c.preset;
  }
}

std::size_t count_of(const EyeEvents& events, EyeMovement movement) {
  return static_cast<std::size_t>(std::count_if(events.events.begin(), events.events.end(),
                                                [&](const EyeEvent& e) { return e.movement == movement; }));
}

// Whatever noise a method fails in, it has said so: of the fixations it finds fewer than nine in ten only where it
// doubts its events. Of good data nothing is said.
TEST(GazeEvents, DetectionDoubtsItselfBeforeItFails) {
  for (const double rate_hz : {300.0, 1000.0}) {
    for (const double noise_deg : {0.01, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0}) {
      SynthSettings settings;
      settings.duration_ns = 30'000'000'000;
      settings.rate_hz = rate_hz;
      settings.noise_deg = noise_deg;
      const SynthGaze synth = synthesize_gaze(settings);
      for (const char* const preset : {"ivt", "idt", "adaptive", "ivdt", "microsaccades"}) {
        const EyeEvents events = detect_events(synth.log, event_preset(preset));
        const double f1 = score_events(synth.truth.events, events.events, EyeMovement::fixation).f1();
        const std::vector<EventDoubt> doubts = doubt_events(synth.log, events);
        const double least_f1 = std::string_view(preset) == "ivdt" ? 0.75 : 0.9;  // it misses small saccades anyway
        if (f1 < least_f1) {
          EXPECT_FALSE(doubts.empty()) << preset << " at " << rate_hz << " Hz with " << noise_deg << " deg: F1 " << f1;
        }
        if (noise_deg < 0.05) {
          EXPECT_TRUE(doubts.empty()) << preset << " at " << rate_hz << " Hz: " << doubts.front().what;
        }
      }
    }
  }
}

TEST(GazeEvents, EkRefusesWhatHasTooFewSamples) {
  SynthSettings settings;
  settings.noise_deg = 0.02;
  settings.rate_hz = 150;
  try {
    detect_events(synthesize_gaze(settings).log, event_preset("microsaccades"));
    FAIL() << "150 Hz were accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("150 Hz are too few for microsaccades"), std::string::npos)
        << error.what();
  }
  settings.rate_hz = 200;
  const SynthGaze synth = synthesize_gaze(settings);
  const EyeEvents events = detect_events(synth.log, event_preset("microsaccades"));
  EXPECT_GT(score_events(synth.truth.events, events.events, EyeMovement::saccade).f1(), 0.9);
}

// Pursuit at 15 deg/s over windows that it crosses by more than D, and none where nothing is followed.
TEST(GazeEvents, IvdtTellsPursuitFromFixation) {
  SynthSettings settings;
  settings.duration_ns = 60'000'000'000;
  settings.seed = 3;
  settings.pursuit_deg_s = 15;
  settings.fixation_s = 0.6;
  settings.noise_deg = 0.01;
  for (const double share : {0.0, 0.5}) {
    settings.pursuit_share = share;
    const SynthGaze synth = synthesize_gaze(settings);
    const EyeEvents events = detect_events(synth.log, event_preset("ivdt-slow"));
    const auto f1 = [&](EyeMovement m) { return score_events(synth.truth.events, events.events, m).f1(); };
    std::printf("ivdt-slow, pursuit share %.1f: F1 fixation %.3f pursuit %.3f\n", share, f1(EyeMovement::fixation),
                f1(EyeMovement::pursuit));
    EXPECT_GT(f1(EyeMovement::fixation), 0.95);
    if (share > 0) {
      EXPECT_GT(f1(EyeMovement::pursuit), 0.9);
    } else {
      EXPECT_LT(count_of(events, EyeMovement::pursuit), count_of(events, EyeMovement::fixation) / 20);
    }
  }
}

// 15/8 A / D, smoothed by the window, and the amplitude to a few times the noise.
TEST(GazeEvents, SaccadesHaveTheirTrueSize) {
  SynthSettings settings;
  settings.rate_hz = 1000;
  settings.duration_ns = 30'000'000'000;
  settings.drift_deg = 0;
  const SynthGaze synth = synthesize_gaze(settings);
  const EyeEvents events = detect_events(synth.log, event_preset("ivt"));
  std::size_t compared = 0;
  for (const EyeEvent& truth : synth.truth.events) {
    for (const EyeEvent& found : events.events) {
      if (truth.movement == EyeMovement::saccade && found.movement == truth.movement &&
          found.begin_ns <= truth.begin_ns + 5'000'000 && found.end_ns >= truth.end_ns - 5'000'000) {
        ++compared;
        EXPECT_NEAR(found.amplitude_deg, truth.amplitude_deg, 0.02);
        EXPECT_NEAR(std::remainder(found.angle_deg - truth.angle_deg, 360), 0, 1);
        EXPECT_LT(found.peak_velocity_deg_s, truth.peak_velocity_deg_s * 1.001);
      }
    }
  }
  EXPECT_GT(compared, 60U);
}

TEST(GazeEvents, TheAdaptiveThresholdFollowsTheNoise) {
  double before = 0;
  for (const double noise : {0.01, 0.1, 0.3}) {
    SynthSettings settings;
    settings.rate_hz = 1000;
    settings.noise_deg = noise;
    const EyeEvents events = detect_events(synthesize_gaze(settings).log, event_preset("adaptive"));
    EXPECT_GT(events.peak_threshold_deg_s, before);
    EXPECT_GT(events.peak_threshold_deg_s, events.onset_threshold_deg_s);
    before = events.peak_threshold_deg_s;
  }
}

TEST(GazeEvents, EventsCoverEverySampleOnce) {
  SynthSettings settings;
  settings.noise_deg = 0.2;
  settings.lost_share = 0.1;
  settings.blinks_per_min = 30;
  settings.kind = GazeKind::direction;
  GazeLog log = synthesize_gaze(settings).log;
  log.head = {{0, {}, {0, 0, 0, 1}}};
  for (const EventPreset& preset : event_presets()) {
    const EyeEvents events = detect_events(log, preset, preset.device);
    std::size_t next = 0;
    for (const EyeEvent& event : events.events) {
      ASSERT_EQ(event.first, next) << preset.name;
      ASSERT_LE(event.first, event.last);
      for (std::size_t i = event.first; i <= event.last; ++i) {
        ASSERT_EQ(events.labels[i], event.movement);
      }
      next = event.last + 1;
    }
    EXPECT_EQ(next, log.samples.size()) << preset.name;
  }
}

TEST(GazeEvents, NothingSeenAndNothingThere) {
  GazeLog log = azimuths({});
  for (const EventPreset& preset : event_presets()) {
    log.head = {{0, {}, {0, 0, 0, 1}}};
    EXPECT_TRUE(detect_events(log, preset, preset.device).events.empty());
  }
  GazeLog lost = azimuths(std::vector<double>(5, kLost));
  EXPECT_EQ(summary(detect_events(lost, event_preset("ivt-attention"))), "l0-4 ");
  GazeLog one = azimuths({0.0});
  EXPECT_EQ(detect_events(one, event_preset("adaptive-hmd")).events.size(), 1U);
}

}  // namespace
}  // namespace gazetrace::gaze_events_test
