// SPDX-License-Identifier: Apache-2.0
// A method of event detection is one file in methods/ and one line in methods.def.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

struct EventMethod {
  std::string name;
  std::string description;
  // Labels the samples that are unclassified in `events.labels`, which are those with a direction. It may also label
  // lost samples in gaps that it bridges. `events.settings` holds the constants.
  void (*classify)(const GazeDirections& gaze, EyeEvents& events);
};

// Runs [first, last] of neighbouring samples with one label, cut where the clock jumps by more than `break_ns`.
struct LabelRun {
  EyeMovement movement = EyeMovement::unclassified;
  std::size_t first = 0, last = 0;
};
std::vector<LabelRun> label_runs(const std::vector<EyeMovement>& labels, const std::vector<std::int64_t>& t_ns);

// Fixations shorter than EventSettings::min_fixation_ns become unclassified.
void drop_short_fixations(const GazeDirections& gaze, EyeEvents& events);

// Makes events of the labels, and measures them.
std::vector<EyeEvent> measure_events(const GazeLog& log, const GazeDirections& gaze, const EyeEvents& labelled);

}  // namespace gazetrace
