// SPDX-License-Identifier: Apache-2.0
// The events that a log states itself, in the same form as detected ones.
#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "core/nan.hpp"
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

// The directions of a log whose places mean no angles: none is known.
GazeDirections unknown_directions(const std::vector<std::int64_t>& t_ns) {
  return {t_ns, std::vector<Vec3d>(t_ns.size(), Vec3d{kNan, kNan, kNan})};
}

// Where on the display a fixation was does not depend on angles.
void place_fixations(const GazeLog& log, EyeEvents& events) {
  for (EyeEvent& event : events.events) {
    if (event.movement != EyeMovement::fixation) {
      continue;
    }
    double u = 0;
    double v = 0;
    double count = 0;
    for (std::size_t i = event.first; i <= event.last; ++i) {
      const GazeSample& sample = log.samples[i];
      if (is_usable(sample.validity)) {
        u += sample.u;
        v += sample.v;
        ++count;
      }
    }
    event.u = count > 0 ? u / count : event.u;
    event.v = count > 0 ? v / count : event.v;
  }
}

EyeEvent::Stated what_is_stated(const GazeEvent& event) {
  return {event.begin_ns, event.end_ns, event.stated_duration_ns, event.stated_amplitude_deg,
          event.stated_peak_velocity_deg_s};
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
  std::map<std::size_t, EyeEvent::Stated> stated;  // by the first sample
  const Eye eye = eye_of_events(log);
  for (const GazeEvent& event : log.events) {
    if (event.type == GazeEventType::blink && event.eye == eye) {
      // The saccade around a blink is blink as well, and the tracker's own times are those of the blink.
      auto i = static_cast<std::size_t>(std::lower_bound(t_ns.begin(), t_ns.end(), event.begin_ns) - t_ns.begin());
      while (i > 0 && i < events.labels.size() && events.labels[i] == EyeMovement::blink &&
             events.labels[i - 1] == EyeMovement::blink) {
        --i;
      }
      stated.emplace(i, what_is_stated(event));
      continue;
    }
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
    bool is_first = true;
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
      // Lost samples belong to it as well: where a tracker bridged a gap, the event went on.
      if (events.labels[i] == EyeMovement::unclassified || events.labels[i] == EyeMovement::lost) {
        events.labels[i] = event.type == GazeEventType::fixation ? EyeMovement::fixation : EyeMovement::saccade;
        if (is_first) {
          stated.emplace(i, what_is_stated(event));
          events.cuts.push_back(i);
          is_first = false;
        }
      }
    }
  }
  std::sort(events.cuts.begin(), events.cuts.end());
  const bool has_angles = knows_angles(log);
  events.events = measure_events(log, has_angles ? gaze_directions(log) : unknown_directions(t_ns), events);
  if (!has_angles && log.kind == GazeKind::screen) {
    place_fixations(log, events);
  }
  for (EyeEvent& event : events.events) {
    if (const auto found = stated.find(event.first); found != stated.end()) {
      event.stated = found->second;
    }
  }
  return events;
}

}  // namespace gazetrace
