// SPDX-License-Identifier: Apache-2.0
// I-VT: slower than a threshold is a fixation, faster a saccade. Olsen, "The Tobii I-VT fixation filter", 2012: gap
// fill-in (linear), velocity over a window, classification, merging of adjacent fixations by time and by the angle
// between their centres, discarding of short ones. The classification is Salvucci & Goldberg 2000. The eye selection
// and the noise reduction of that filter are left out here, because reading (`gaze-eye`) and processing do them.
#include <cstddef>

#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

// Lost samples between two seen samples that are at most `max_gap_ns` apart are interpolated between these.
GazeDirections bridged(const GazeDirections& gaze, const EyeEvents& events) {
  GazeDirections filled = gaze;
  const std::size_t count = gaze.t_ns.size();
  for (std::size_t i = 1; i < count; ++i) {
    if (is_seen(gaze.direction[i]) || !is_seen(gaze.direction[i - 1])) {
      continue;
    }
    std::size_t end = i;
    bool blink = false;
    while (end < count && !is_seen(gaze.direction[end])) {
      blink = blink || events.labels[end] == EyeMovement::blink;
      ++end;
    }
    if (end == count) {
      break;
    }
    const std::int64_t gap_ns = gaze.t_ns[end] - gaze.t_ns[i - 1];
    if (!blink && gap_ns <= events.settings.max_gap_ns) {
      for (std::size_t k = i; k < end; ++k) {
        const double s = static_cast<double>(gaze.t_ns[k] - gaze.t_ns[i - 1]) / static_cast<double>(gap_ns);
        filled.direction[k] = between_directions(gaze.direction[i - 1], gaze.direction[end], s);
      }
    }
    i = end;
  }
  return filled;
}

struct Fixation {
  std::size_t first = 0, last = 0;
  Vec3d sum;
};

// One pass over neighbouring fixations; returns whether any two were merged.
bool merge_neighbours(const GazeDirections& gaze, EyeEvents& events) {
  const EventSettings& settings = events.settings;
  bool merged = false;
  Fixation before;
  bool has_before = false;
  const std::int64_t break_ns = break_step_ns(median_step_ns(gaze.t_ns));
  for (const LabelRun& run : label_runs(events.labels, gaze.t_ns)) {
    // What the eye did in a break of the clock is unknown, and runs end there in any case: nothing is merged across it.
    has_before = has_before && gaze.t_ns[run.first] - gaze.t_ns[run.first - 1] <= break_ns;
    if (run.movement != EyeMovement::fixation) {
      // Lost samples do not count as a pause between two parts of a fixation.
      has_before = has_before && run.movement == EyeMovement::saccade;
      continue;
    }
    Fixation fixation{run.first, run.last, {}};
    for (std::size_t i = run.first; i <= run.last; ++i) {
      fixation.sum += gaze.direction[i];
    }
    if (has_before && gaze.t_ns[run.first] - gaze.t_ns[before.last] <= settings.merge_gap_ns &&
        angle_between_rad(before.sum, fixation.sum) * kDegPerRad <= settings.merge_angle_deg) {
      for (std::size_t i = before.last + 1; i < run.first; ++i) {
        events.labels[i] = EyeMovement::fixation;
      }
      before = {before.first, fixation.last, before.sum + fixation.sum};
      merged = true;
    } else {
      before = fixation;
    }
    has_before = true;
  }
  return merged;
}

}  // namespace

void classify_ivt(const GazeDirections& gaze, EyeEvents& events) {
  const GazeDirections filled = bridged(gaze, events);
  const std::vector<double> speed = angular_speed_deg_s(filled, events.settings.velocity_window_ns);
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (!std::isnan(speed[i])) {
      events.labels[i] = speed[i] < events.settings.velocity_deg_s ? EyeMovement::fixation : EyeMovement::saccade;
    }
  }
  // A fixation that has grown may reach the next one, so passes are repeated until there is nothing left to merge. They
  // come to an end, because every merging leaves fewer runs than there were.
  while (events.settings.merge_gap_ns > 0 && merge_neighbours(filled, events)) {
  }
  drop_short(EyeMovement::fixation, gaze, events);
}

}  // namespace gazetrace
