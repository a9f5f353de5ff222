// SPDX-License-Identifier: Apache-2.0
// Whether detected events can be those of an eye. A method that does not suit the noise or the rate of a log gives
// events all the same; here they are compared with published eye movements.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

// How noisy a log is by the measure of event detection. Medians over all samples that follow each other, most of which
// lie in fixations: they are known even where the noise leaves no fixation to measure it in.
struct EventNoise {
  // Root mean square of the angle from sample to sample, from the median under the assumption of normal noise of equal
  // size in both axes (Rayleigh: RMS = median / sqrt(ln 2)); NaN where fewer than ten pairs of samples are seen.
  double rms_s2s_deg = 0;
  double median_speed_deg_s = 0;  // over EventSettings::velocity_window_ns
  double median_extent_deg = 0;   // of azimuth plus elevation, over windows of EventSettings::min_fixation_ns
};
EventNoise measure_event_noise(const GazeLog& log, const EventSettings& settings);

struct EventDoubt {
  std::string code;  // "noise", "few-fixations", "short-fixations", "many-saccades", "long-saccades", "main-sequence"
  std::string what;  // one sentence with the figures and the published ones
};

// Empty where nothing speaks against the events. Sources of the limits:
//   fixations  0.2 to 0.4 s in most tasks, and about three saccades a second: Rayner, Psychological Bulletin 124, 1998;
//              Henderson, Trends in Cognitive Sciences 7, 2003
//   durations of saccades  2.2 ms/deg * amplitude + 21 ms: Carpenter, Movements of the Eyes, 1988
//   main sequence  peak velocity = 500 deg/s * (1 - exp(-amplitude / 10.2 deg)): after Bahill, Clark & Stark,
//              Mathematical Biosciences 24, 1975; Boghen et al., Investigative Ophthalmology 13, 1974
// The limits here are two to three times as wide, and are not applied to fewer events than a statement needs.
std::vector<EventDoubt> doubt_events(const GazeLog& log, const EyeEvents& events);

// events_as_json (gaze_events.hpp) with "doubts", a list of codes and sentences; an empty list: none was found.
std::string events_as_json(const EyeEvents& events, const GazeLog& log, const std::vector<EventDoubt>& doubts);

// Better methods for the log, found by trying: presets for the same device and steps of processing, as options with
// their results, such as "`method` idt (47 fixations, 46 saccades)". Only those that leave no doubt; empty: none does.
std::vector<std::string> better_event_methods(const GazeLog& log, const EyeEvents& events);

// A sentence for each doubt and, where there is one, another with a remedy. Options stand in back quotes.
std::vector<std::string> doubts_in_words(const std::vector<EventDoubt>& doubts, const EyeEvents& events,
                                         const GazeLog& log);

}  // namespace gazetrace
