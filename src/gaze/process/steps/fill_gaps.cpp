// SPDX-License-Identifier: Apache-2.0
// Lost samples between two usable ones are interpolated linearly between them (on a screen in u and v, else along the
// arc). This is done where the gap is no longer than `max` from sample to sample (75 ms: Olsen 2012), the log calls
// nothing in it a blink or a saccade, and the gaze before and after it is within `angle`. Gaze that moved farther has
// made a saccade in the gap, which must not be interpolated across.
#include <fmt/format.h>

#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

std::string apply_fill_gaps(GazeLog& log, const GazeStep& step) {
  const GazeDirections gaze = gaze_directions(log);
  const std::int64_t max_ns = step.duration_ns("max");
  // What the log calls a blink or a saccade; asked with increasing times.
  const std::vector<const GazeEvent*> named = events_in_time(log, [](const GazeEvent& event) {
    return event.type == GazeEventType::blink || event.type == GazeEventType::saccade;
  });
  auto next = named.begin();
  std::size_t filled = 0;
  std::size_t samples = 0;
  std::size_t longer = 0;
  std::size_t blinks = 0;
  std::size_t moved = 0;
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    if (is_seen(gaze.direction[i]) || !is_seen(gaze.direction[i - 1])) {
      continue;
    }
    std::size_t end = i;
    bool blink = false;
    while (end < log.samples.size() && !is_seen(gaze.direction[end])) {
      blink = blink || log.samples[end].validity == GazeValidity::blink;
      ++end;
    }
    if (end == log.samples.size()) {
      break;
    }
    const GazeSample before = log.samples[i - 1];
    const GazeSample& after = log.samples[end];
    while (next != named.end() && (*next)->end_ns <= before.t_ns) {
      ++next;
    }
    const GazeEvent* const event = next != named.end() && (*next)->begin_ns < after.t_ns ? *next : nullptr;
    blink = blink || (event != nullptr && event->type == GazeEventType::blink);
    const bool saccade =
        event != nullptr ||
        angle_between_rad(gaze.direction[i - 1], gaze.direction[end]) * kDegPerRad > step.value("angle");
    if (after.t_ns - before.t_ns > max_ns) {
      ++longer;
    } else if (blink) {
      ++blinks;
    } else if (saccade) {
      ++moved;
    } else {
      ++filled;
      samples += end - i;
      for (std::size_t k = i; k < end; ++k) {
        GazeSample& sample = log.samples[k];
        const double s = static_cast<double>(sample.t_ns - before.t_ns) / static_cast<double>(after.t_ns - before.t_ns);
        sample.validity = GazeValidity::interpolated;
        sample.direction = log.kind == GazeKind::direction
                               ? between_directions(gaze.direction[i - 1], gaze.direction[end], s)
                               : sample.direction;
        sample.u = before.u * (1 - s) + after.u * s;
        sample.v = before.v * (1 - s) + after.v * s;
      }
    }
    i = end;
  }
  return fmt::format("{} gaps filled, {} samples; left: {} longer, {} blinks, {} across a saccade", filled, samples,
                     longer, blinks, moved);
}

}  // namespace gazetrace
