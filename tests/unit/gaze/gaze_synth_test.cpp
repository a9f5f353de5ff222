// SPDX-License-Identifier: Apache-2.0
// Synthetic logs: what they claim of themselves, measured on their samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "gazetrace/gaze_write.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_synth_test {
namespace {

// A standard deviation of 60 degrees turns more than a tenth of the directions past 90 degrees: the eye looks, but at
// no place of the screen's plane.
TEST(GazeSynth, GazeThatIsTurnedAwayHasNoPlace) {
  SynthSettings settings;
  settings.display = {1920, 1080, 600, 400, 10, 0, 0};
  settings.amplitude_deg = 30;
  settings.noise_deg = 10;
  std::size_t away = 0;
  for (const GazeSample& sample : synthesize_gaze(settings).log.samples) {
    EXPECT_NE(sample.validity, GazeValidity::lost);
    EXPECT_EQ(std::isnan(sample.u), std::isnan(sample.v));
    if (std::isnan(sample.u)) {
      EXPECT_EQ(sample.validity, GazeValidity::off_screen);
      ++away;
    }
  }
  EXPECT_GT(away, 0U);
}

TEST(GazeSynth, SaccadesAreOnTheMainSequence) {
  SynthSettings settings;
  settings.rate_hz = 20'000;
  settings.drift_deg = 0;
  const SynthGaze synth = synthesize_gaze(settings);
  const GazeDirections gaze = gaze_directions(synth.log);
  std::size_t saccades = 0;
  for (const EyeEvent& event : synth.truth.events) {
    if (event.movement != EyeMovement::saccade || event.last + 1 == gaze.t_ns.size()) {
      continue;
    }
    ++saccades;
    double peak = 0;
    for (std::size_t i = event.first; i < event.last; ++i) {
      peak = std::max(peak, angle_between_rad(gaze.direction[i], gaze.direction[i + 1]) * kDegPerRad * 20'000);
    }
    const double amplitude = angle_between_rad(gaze.direction[event.first - 1], gaze.direction[event.last + 1]);
    EXPECT_NEAR(amplitude * kDegPerRad, event.amplitude_deg, 1e-6);
    // 21 ms and 2.2 ms a degree; the profile's steepest slope is 15/8.
    EXPECT_NEAR(peak, 1.875 * event.amplitude_deg / (0.021 + 0.0022 * event.amplitude_deg), 1e-3 * peak);
    EXPECT_NEAR(peak, event.peak_velocity_deg_s, 1e-3 * peak);
  }
  EXPECT_GT(saccades, 20U);
}

TEST(GazeSynth, NoiseHasTheStatedSpread) {
  SynthSettings settings;
  settings.duration_ns = 20'000'000'000;
  settings.drift_deg = 0;
  const SynthGaze clean = synthesize_gaze(settings);
  settings.noise_deg = 0.3;
  const SynthGaze noisy = synthesize_gaze(settings);
  const GazeDirections a = gaze_directions(clean.log);
  const GazeDirections b = gaze_directions(noisy.log);
  double squares = 0;
  for (std::size_t i = 0; i < a.t_ns.size(); ++i) {
    const double angle = angle_between_rad(a.direction[i], b.direction[i]) * kDegPerRad / 0.3;
    squares += angle * angle;
  }
  // A chi-square sum of 2 n terms; 4.9 standard deviations of its normal limit are 1e-6.
  const double freedom = 2.0 * static_cast<double>(a.t_ns.size());
  EXPECT_NEAR(squares, freedom, 4.9 * std::sqrt(2 * freedom));
}

TEST(GazeSynth, LosesTheStatedShare) {
  SynthSettings settings;
  settings.duration_ns = 100'000'000'000;
  settings.lost_share = 0.1;
  const SynthGaze synth = synthesize_gaze(settings);
  const auto lost = std::count_if(synth.log.samples.begin(), synth.log.samples.end(),
                                  [](const GazeSample& s) { return s.validity == GazeValidity::lost; });
  // Stretches of four: a binomial of a quarter of the samples.
  const double stretches = static_cast<double>(synth.log.samples.size()) / 4;
  EXPECT_NEAR(static_cast<double>(lost) / 4, 0.1 * stretches, 4.9 * std::sqrt(stretches * 0.1 * 0.9));
}

TEST(GazeSynth, DriftHasTheStatedSize) {
  SynthSettings settings;
  settings.duration_ns = 200'000'000'000;
  settings.drift_deg = 0;
  const GazeDirections still = gaze_directions(synthesize_gaze(settings).log);
  settings.drift_deg = 0.2;
  const GazeDirections drifting = gaze_directions(synthesize_gaze(settings).log);
  double squares = 0;
  for (std::size_t i = 0; i < still.t_ns.size(); ++i) {
    squares += std::pow(angle_between_rad(still.direction[i], drifting.direction[i]) * kDegPerRad, 2);
  }
  // Exact over whole periods; 200 s hold dozens of the slowest.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(still.t_ns.size())), 0.2, 0.01);
}

TEST(GazeSynth, SameSeedSameBitsOtherSeedOtherGaze) {
  SynthSettings settings;
  settings.noise_deg = 0.1;
  const SynthGaze a = synthesize_gaze(settings);
  const SynthGaze b = synthesize_gaze(settings);
  settings.seed = 2;
  const SynthGaze c = synthesize_gaze(settings);
  ASSERT_EQ(a.log.samples.size(), 5000U);
  bool differs = false;
  for (std::size_t i = 0; i < a.log.samples.size(); ++i) {
    EXPECT_EQ(a.log.samples[i].u, b.log.samples[i].u);
    differs = differs || a.log.samples[i].u != c.log.samples[i].u;
  }
  EXPECT_TRUE(differs);
}

TEST(GazeSynth, PursuitGoesAtItsSpeed) {
  SynthSettings settings;
  settings.pursuit_share = 0.5;
  settings.pursuit_deg_s = 8;
  settings.drift_deg = 0;
  settings.rate_hz = 1000;
  const SynthGaze synth = synthesize_gaze(settings);
  const GazeDirections gaze = gaze_directions(synth.log);
  std::size_t pursuits = 0;
  std::size_t at_speed = 0;
  for (const EyeEvent& event : synth.truth.events) {
    if (event.movement != EyeMovement::pursuit || event.last + 1 == gaze.t_ns.size()) {
      continue;
    }
    ++pursuits;
    at_speed += std::abs(event.mean_velocity_deg_s - 8) < 1e-6 ? 1 : 0;  // slower where the screen ends
    for (std::size_t i = event.first + 1; i + 1 < event.last; ++i) {
      const double speed = angle_between_rad(gaze.direction[i], gaze.direction[i + 1]) * kDegPerRad * 1000;
      ASSERT_NEAR(speed, event.mean_velocity_deg_s, 1e-6 * speed);
    }
  }
  EXPECT_GT(pursuits, 5U);
  EXPECT_GT(2 * at_speed, pursuits);
}

TEST(GazeSynth, SurvivesItsOwnFile) {
  SynthSettings settings;
  settings.kind = GazeKind::direction;
  settings.blinks_per_min = 30;
  const SynthGaze synth = synthesize_gaze(settings);
  const TextFiles files;
  write_gaze_csv(synth.log, files.path("synth.csv"));
  const GazeLog back = load_gaze_log(files.path("synth.csv"), {});
  ASSERT_EQ(back.samples.size(), synth.log.samples.size());
  for (std::size_t i = 0; i < back.samples.size(); ++i) {
    EXPECT_EQ(back.samples[i].t_ns, synth.log.samples[i].t_ns);
    EXPECT_EQ(back.samples[i].validity, synth.log.samples[i].validity);
    if (is_usable(back.samples[i].validity)) {
      EXPECT_EQ(back.samples[i].direction, synth.log.samples[i].direction);
    }
  }
}

TEST(GazeSynth, RefusesWhatNoEyeDoes) {
  SynthSettings settings;
  settings.rate_hz = 0;
  EXPECT_THROW(synthesize_gaze(settings), Error);
  settings = {};
  settings.lost_share = 1.5;
  EXPECT_THROW(synthesize_gaze(settings), Error);
  settings = {};
  settings.noise_deg = std::nan("");
  EXPECT_THROW(synthesize_gaze(settings), Error);
}

}  // namespace
}  // namespace gazetrace::gaze_synth_test
