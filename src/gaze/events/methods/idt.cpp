// SPDX-License-Identifier: Apache-2.0
// I-DT: a window of the shortest fixation's length slides until the gaze stays within D in it, and then grows as long
// as it does; D = (max x - min x) + (max y - min y). Gaze that was seen outside such windows counts as saccade.
// Salvucci & Goldberg, "Identifying fixations and saccades in eye-tracking protocols", 2000.
#include <cstddef>

#include "gaze/events/dispersion_window.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {

void classify_idt(const GazeDirections& gaze, EyeEvents& events) {
  const EventSettings& settings = events.settings;
  std::vector<EyeMovement>& labels = events.labels;
  DispersionWindow window(gaze.direction);
  for (const LabelRun& run : label_runs(labels, gaze.t_ns)) {
    if (run.movement != EyeMovement::unclassified) {
      continue;
    }
    const std::size_t end = run.last + 1;
    label_samples(labels, run.first, end, EyeMovement::saccade);
    find_still(gaze, run.first, end, settings.min_fixation_ns, settings.dispersion_deg, window,
               [&](std::size_t begin, std::size_t still_end) {
                 label_samples(labels, begin, still_end, EyeMovement::fixation);
                 events.cuts.push_back(still_end);  // the next fixation may begin directly here
               });
  }
}

}  // namespace gazetrace
