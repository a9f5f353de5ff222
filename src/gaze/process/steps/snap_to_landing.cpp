// SPDX-License-Identifier: Apache-2.0
// Perfect prediction of saccades: while a saccade lasts, the gaze is already where it will land. Only a program that
// has the whole log can do this; results made with it show the most that prediction could gain. Saccades are those of
// the recording's default method (gaze_events.hpp).
#include <fmt/format.h>

#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

std::string apply_snap_to_landing(GazeLog& log, const GazeStep& /*step*/) {
  const EyeEvents events = detect_events(log, default_event_preset(log));
  std::size_t snapped = 0;
  for (const EyeEvent& event : events.events) {
    const std::size_t landing = event.last + 1;
    if (event.movement != EyeMovement::saccade || landing >= log.samples.size() ||
        events.labels[landing] != EyeMovement::fixation || !is_usable(log.samples[landing].validity)) {
      continue;  // where it lands is not known
    }
    ++snapped;
    for (std::size_t i = event.first; i <= event.last; ++i) {
      if (is_usable(log.samples[i].validity)) {
        log.samples[i].u = log.samples[landing].u;
        log.samples[i].v = log.samples[landing].v;
        log.samples[i].direction = log.samples[landing].direction;
        log.samples[i].validity = log.samples[landing].validity;
      }
    }
  }
  return fmt::format("{} saccades, by {}", snapped, events.preset);
}

}  // namespace gazetrace
