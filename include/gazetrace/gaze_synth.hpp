// SPDX-License-Identifier: Apache-2.0
// Synthetic gaze logs whose true eye movements are known. They test readers, filters and classifiers of gaze.
#pragma once

#include <cstdint>

#include "gazetrace/display.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

struct SynthSettings {
  std::int64_t duration_ns = 10'000'000'000;
  double rate_hz = 500;
  std::uint64_t seed = 1;
  GazeKind kind = GazeKind::screen;  // or GazeKind::direction
  // The display of GazeKind::screen. Directions stay within 20 deg to the sides and 15 deg up and down.
  DisplayGeometry display{1920, 1080, 50.9174, 28.6411, 65, 0, 0};
  double fixation_s = 0.3;   // mean of the durations, of which none is shorter than a third of it
  double amplitude_deg = 5;  // mean of the saccades' amplitudes, of which none is smaller than 1 deg
  double drift_deg = 0.05;   // root mean square of the slow wandering during fixations
  double pursuit_share = 0;  // share of the fixations that move at `pursuit_deg_s` instead
  double pursuit_deg_s = 10;
  double noise_deg = 0;       // standard deviation of the white noise in azimuth and in elevation
  double lost_share = 0;      // share of the samples that are lost, in stretches of four
  double blinks_per_min = 0;  // each lasts 100 to 250 ms
};

struct SynthGaze {
  GazeLog log;      // states its kind, rate and geometry; its clock is called "synthetic"
  EyeEvents truth;  // a label for every sample; amplitudes and peak velocities are those of the formulas
};

// Fixations and saccades take turns. A saccade of A degrees takes 21 ms + 2.2 ms A (the main sequence; Bahill, Clark &
// Stark 1975, figures of Carpenter 1988). It moves on a great circle with the minimum-jerk profile 10 s^3 - 15 s^4 +
// 6 s^5 (Flash & Hogan 1985), so that its peak velocity is 1.875 A / duration. The same settings give the same bits.
// Throws Error(usage) for settings out of range.
SynthGaze synthesize_gaze(const SynthSettings& settings);

double main_sequence_duration_s(double amplitude_deg);

}  // namespace gazetrace
