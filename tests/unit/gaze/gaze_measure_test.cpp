// SPDX-License-Identifier: Apache-2.0
// Figures about recordings: quality of the data and the main sequence.
#include "gazetrace/gaze_measure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/gaze_synth.hpp"

namespace gazetrace::gaze_measure_test {
namespace {

TEST(GazeMeasure, QualityCountsWhatIsMissing) {
  // 100 Hz, two blocks of 1 s with a pause of 10 s; a quarter of the first is lost, and 10 rows of the second are not
  // there at all.
  GazeLog log;
  log.kind = GazeKind::direction;
  log.nominal_rate_hz = 100;
  for (std::int64_t block = 0; block < 2; ++block) {
    const std::int64_t begin_ns = block * 11'000'000'000;
    for (std::int64_t i = 0; i < 100; ++i) {
      if (block == 1 && i >= 40 && i < 50) {
        continue;
      }
      GazeSample sample;
      sample.t_ns = begin_ns + i * 10'000'000;
      sample.validity = block == 0 && i >= 75 ? GazeValidity::lost : GazeValidity::ok;
      log.samples.push_back(sample);
    }
    log.events.push_back({GazeEventType::segment, Eye::cyclopean, begin_ns, begin_ns + 990'000'000, "", 0});
  }
  log.calibrations = {{0, Eye::left, 0.4, 0.9, 1}, {0, Eye::right, 0.6, 1.1, 2}};
  const GazeQuality q = measure_quality(log);
  EXPECT_EQ(q.usable, 165U);
  EXPECT_NEAR(q.duration_s, 2, 1e-9);
  EXPECT_NEAR(q.data_loss, 35.0 / 200, 1e-9);
  EXPECT_NEAR(q.effective_rate_hz, 82.5, 1e-9);
  EXPECT_NEAR(q.accuracy_deg, 0.5, 1e-12);
  EXPECT_NEAR(q.accuracy_max_deg, 1.1, 1e-12);
}

TEST(GazeMeasure, TheFitFindsThePowerLaw) {
  std::vector<EyeEvent> events;
  for (int i = 0; i < 40; ++i) {
    EyeEvent event;
    event.movement = EyeMovement::saccade;
    event.amplitude_deg = 0.6 + 0.5 * i;
    event.peak_velocity_deg_s = 90 * std::pow(event.amplitude_deg, 0.55);
    events.push_back(event);
  }
  const MainSequence fit = fit_main_sequence(events);
  EXPECT_EQ(fit.saccades, 40U);
  EXPECT_NEAR(fit.factor, 90, 1e-6);
  EXPECT_NEAR(fit.exponent, 0.55, 1e-9);
  EXPECT_NEAR(fit.correlation, 1, 1e-9);
  events.resize(4);
  EXPECT_TRUE(std::isnan(fit_main_sequence(events).factor));
}

// Precision of synthetic gaze is that of its noise: sqrt(2) sd in each axis from sample to sample, sd about the mean.
TEST(GazeMeasure, PrecisionIsThatOfTheNoise) {
  SynthSettings settings;
  settings.duration_ns = 30'000'000'000;
  settings.drift_deg = 0;
  settings.fixation_s = 2;  // the flanks of saccades belong to the stretches that are measured
  settings.noise_deg = 0.05;
  const GazeMeasurements measured = measure_gaze(synthesize_gaze(settings).log, {});
  const GazeQuality& q = measured.quality.front();
  EXPECT_EQ(q.precision_unit, "deg");
  EXPECT_NEAR(q.precision_rms_s2s, 0.05 * 2, 0.006);
  EXPECT_NEAR(q.precision_sd, 0.05 * std::sqrt(2.0), 0.006);
  EXPECT_TRUE(std::isnan(q.accuracy_deg));
  EXPECT_NE(measured.json.find("\"accuracy_deg\": null"), std::string::npos);
}

// Trials that the recording does not name, and those of its blocks.
TEST(GazeMeasure, TrialsAreThoseOfTheBlocks) {
  SynthSettings settings;
  settings.duration_ns = 4'000'000'000;
  GazeLog log = synthesize_gaze(settings).log;
  EXPECT_TRUE(measure_gaze(log, {}).trials.empty());
  log.events.push_back({GazeEventType::segment, Eye::cyclopean, 0, 1'000'000'000, "", 0});
  log.events.push_back({GazeEventType::segment, Eye::cyclopean, 2'000'000'000, 3'000'000'000, "", 0});
  const GazeMeasurements measured = measure_gaze(log, {});
  ASSERT_EQ(measured.trials.size(), 2U);
  EXPECT_EQ(measured.trials[1].begin_ns, 2'000'000'000);
}

}  // namespace
}  // namespace gazetrace::gaze_measure_test
