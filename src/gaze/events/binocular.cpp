// SPDX-License-Identifier: Apache-2.0
// The two eyes of a log, each by itself and held against each other.
#include <algorithm>
#include <cmath>

#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {

GazeLog one_eye(const GazeLog& log, Eye eye) {
  if (log.eyes.size() != log.samples.size() || log.samples.empty()) {
    throw Error(ErrorKind::input, log.source, "does not hold both eyes separately");
  }
  GazeLog alone = log;
  alone.eyes.clear();
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const EyeGaze& gaze = eye == Eye::left ? log.eyes[i].left : log.eyes[i].right;
    GazeSample& sample = alone.samples[i];
    sample.eye = eye;
    sample.validity = gaze.validity;
    sample.confidence = gaze.confidence;
    sample.pupil = gaze.pupil;
    if (log.kind == GazeKind::direction) {
      sample.direction = gaze.at;
    } else {
      sample.u = gaze.at.x;
      sample.v = gaze.at.y;
    }
    if (is_usable(sample.validity) && (std::isnan(gaze.at.x) || std::isnan(gaze.at.y))) {
      sample.validity = GazeValidity::lost;
    }
  }
  return alone;
}

EyeEvents binocular_events(const GazeLog& log, const EventPreset& preset, std::optional<GazeDevice> device) {
  const GazeLog left = one_eye(log, Eye::left);
  EyeEvents events = detect_events(left, preset, device);
  const EyeEvents other = detect_events(one_eye(log, Eye::right), preset, device);
  const auto is_fast = [](EyeMovement m) { return m == EyeMovement::saccade || m == EyeMovement::microsaccade; };
  for (const EyeEvent& event : events.events) {
    const auto first = other.labels.begin() + static_cast<std::ptrdiff_t>(event.first);
    const auto end = other.labels.begin() + static_cast<std::ptrdiff_t>(event.last) + 1;
    if (is_fast(event.movement) && std::none_of(first, end, is_fast)) {
      std::fill(events.labels.begin() + static_cast<std::ptrdiff_t>(event.first),
                events.labels.begin() + static_cast<std::ptrdiff_t>(event.last) + 1, EyeMovement::fixation);
    }
  }
  events.events = measure_events(left, gaze_directions(left, events.settings.space), events);
  return events;
}

}  // namespace gazetrace
