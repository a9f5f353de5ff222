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

// Labels the samples [first, end).
void label_samples(std::vector<EyeMovement>& labels, std::size_t first, std::size_t end, EyeMovement movement);

// Fixations, or other movements, shorter than EventSettings::min_fixation_ns become unclassified.
void drop_short(EyeMovement movement, const GazeDirections& gaze, EyeEvents& events);

// When the eye was not seen: unclassified where the sample is usable, else blink or lost as the log says.
std::vector<EyeMovement> absence_labels(const GazeLog& log, const std::vector<std::int64_t>& t_ns);

// Losses that are as long as a blink and lie between two times at which the eye was seen become blinks. Where the log
// calls only one part of a loss a blink and the rest lost, the whole loss becomes the blink. With a max_ns of 0 nothing
// changes.
void infer_blinks(const std::vector<std::int64_t>& t_ns, std::int64_t min_ns, std::int64_t max_ns,
                  std::vector<EyeMovement>& labels);

// Makes events of the labels, and measures them.
std::vector<EyeEvent> measure_events(const GazeLog& log, const GazeDirections& gaze, const EyeEvents& labelled);

}  // namespace gazetrace
