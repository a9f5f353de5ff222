// SPDX-License-Identifier: Apache-2.0
// I-DT: a window of the shortest fixation's length slides until the gaze stays within D in it, and then grows as long
// as it does; D = (max x - min x) + (max y - min y). Gaze that was seen outside such windows counts as saccade.
// Salvucci & Goldberg, "Identifying fixations and saccades in eye-tracking protocols", 2000.
#include <algorithm>
#include <cstddef>

#include "gaze/angles.hpp"
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
    std::fill(labels.begin() + static_cast<std::ptrdiff_t>(run.first),
              labels.begin() + static_cast<std::ptrdiff_t>(end), EyeMovement::saccade);
    window.start(run.first);
    for (std::size_t begin = run.first; begin < end;) {
      while (window.end() < end &&
             (window.end() == begin || gaze.t_ns[window.end() - 1] - gaze.t_ns[begin] < settings.min_fixation_ns)) {
        window.push();
      }
      if (gaze.t_ns[window.end() - 1] - gaze.t_ns[begin] < settings.min_fixation_ns) {
        break;
      }
      if (window.dispersion_deg() > settings.dispersion_deg) {
        window.pop();
        ++begin;
        continue;
      }
      while (window.end() < end && window.dispersion_with_next_deg() <= settings.dispersion_deg) {
        window.push();
      }
      std::fill(labels.begin() + static_cast<std::ptrdiff_t>(begin),
                labels.begin() + static_cast<std::ptrdiff_t>(window.end()), EyeMovement::fixation);
      begin = window.end();
      events.cuts.push_back(begin);  // the next fixation may begin directly here
      if (begin < end) {
        window.start(begin);
      }
    }
  }
}

}  // namespace gazetrace
