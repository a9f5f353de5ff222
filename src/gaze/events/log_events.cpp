// SPDX-License-Identifier: Apache-2.0
// The events that a log states itself, in the same form as detected ones.
#include <algorithm>
#include <array>
#include <limits>

#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

// The eye whose events are taken: the eye of the gaze or, where the gaze was made from both eyes, the eye that has more
// events.
Eye eye_of_events(const GazeLog& log) {
  std::array<std::size_t, 3> count{};
  for (const GazeEvent& event : log.events) {
    if (event.type == GazeEventType::fixation || event.type == GazeEventType::saccade) {
      ++count[static_cast<std::size_t>(event.eye)];
    }
  }
  const Eye wanted = log.samples.empty() ? Eye::cyclopean : log.samples.front().eye;
  if (count[static_cast<std::size_t>(wanted)] > 0) {
    return wanted;
  }
  return static_cast<Eye>(std::max_element(count.begin(), count.end()) - count.begin());
}

}  // namespace

EyeEvents events_of_log(const GazeLog& log) {
  EyeEvents events;
  events.preset = "log";
  events.peak_threshold_deg_s = events.onset_threshold_deg_s = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::int64_t> t_ns = times_of(log);
  for (const GazeSample& sample : log.samples) {
    events.labels.push_back(is_usable(sample.validity)               ? EyeMovement::unclassified
                            : sample.validity == GazeValidity::blink ? EyeMovement::blink
                                                                     : EyeMovement::lost);
  }
  const Eye eye = eye_of_events(log);
  for (const GazeEvent& event : log.events) {
    const bool moves = event.type == GazeEventType::fixation || event.type == GazeEventType::saccade;
    if (!moves || event.eye != eye) {
      continue;
    }
    const auto first = std::lower_bound(t_ns.begin(), t_ns.end(), event.begin_ns) - t_ns.begin();
    const auto end = std::upper_bound(t_ns.begin() + first, t_ns.end(), event.end_ns) - t_ns.begin();
    // To a tracker a blink looks like a saccade away and back again.
    const bool blinks = std::find(events.labels.begin() + first, events.labels.begin() + end, EyeMovement::blink) !=
                        events.labels.begin() + end;
    if (event.type == GazeEventType::saccade && blinks) {
      continue;
    }
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
      // Lost samples belong to it as well: where a tracker bridged a gap, the event went on.
      if (events.labels[i] == EyeMovement::unclassified || events.labels[i] == EyeMovement::lost) {
        events.labels[i] = event.type == GazeEventType::fixation ? EyeMovement::fixation : EyeMovement::saccade;
      }
    }
  }
  if (knows_angles(log)) {
    events.events = measure_events(log, gaze_directions(log), events);
  } else {
    for (const LabelRun& run : label_runs(events.labels, t_ns)) {
      EyeEvent event;
      event.movement = run.movement;
      event.first = run.first;
      event.last = run.last;
      event.begin_ns = t_ns[run.first];
      event.end_ns = t_ns[run.last];
      const double nan = std::numeric_limits<double>::quiet_NaN();
      event.direction = {nan, nan, nan};
      event.u = event.v = event.amplitude_deg = event.peak_velocity_deg_s = event.mean_velocity_deg_s = nan;
      event.angle_deg = event.dispersion_deg = nan;
      events.events.push_back(event);
    }
  }
  return events;
}

}  // namespace gazetrace
