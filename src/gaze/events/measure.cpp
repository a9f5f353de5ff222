// SPDX-License-Identifier: Apache-2.0
// From labels to events: where a fixation was, and how far and how fast a saccade went.
#include <algorithm>
#include <cmath>

#include "core/nan.hpp"
#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

class Measures {
 public:
  Measures(const GazeLog& log, const GazeDirections& gaze, const EventSettings& settings)
      : log_(log),
        gaze_(gaze),
        break_ns_(break_step_ns(median_step_ns(gaze.t_ns))),
        speed_(angular_speed_deg_s(gaze, settings.velocity_window_ns)) {}

  [[nodiscard]] EyeEvent event(const LabelRun& run) const {
    EyeEvent event;
    event.movement = run.movement;
    event.first = run.first;
    event.last = run.last;
    event.begin_ns = gaze_.t_ns[run.first];
    event.end_ns = gaze_.t_ns[run.last];
    event.direction = {kNan, kNan, kNan};
    event.u = event.v = event.amplitude_deg = event.angle_deg = event.dispersion_deg = kNan;
    event.peak_velocity_deg_s = event.mean_velocity_deg_s = kNan;
    if (run.movement == EyeMovement::fixation) {
      measure_fixation(event);
    } else if (run.movement == EyeMovement::saccade || run.movement == EyeMovement::microsaccade) {
      measure_saccade(event);
    }
    return event;
  }

 private:
  [[nodiscard]] double peak_speed(const EyeEvent& event) const {
    double peak = kNan;
    for (std::size_t i = event.first; i <= event.last; ++i) {
      peak = std::fmax(peak, speed_[i]);  // passes over NaN
    }
    return peak;
  }

  // Of the same filtered speeds, so that it is never above the peak.
  [[nodiscard]] double mean_speed(const EyeEvent& event) const {
    double sum = 0;
    double count = 0;
    for (std::size_t i = event.first; i <= event.last; ++i) {
      if (!std::isnan(speed_[i])) {
        sum += speed_[i];
        ++count;
      }
    }
    return count > 0 ? sum / count : kNan;
  }

  void measure_fixation(EyeEvent& event) const {
    Vec3d sum;
    double u = 0;
    double v = 0;
    double count = 0;
    for (std::size_t i = event.first; i <= event.last; ++i) {
      if (is_seen(gaze_.direction[i])) {
        sum += gaze_.direction[i];
        u += log_.samples[i].u;
        v += log_.samples[i].v;
        ++count;
      }
    }
    if (count == 0) {
      return;
    }
    event.direction = normalize(sum);
    if (log_.kind == GazeKind::screen) {
      event.u = u / count;
      event.v = v / count;
    }
    double squares = 0;
    for (std::size_t i = event.first; i <= event.last; ++i) {
      if (is_seen(gaze_.direction[i])) {
        const double angle = angle_between_rad(gaze_.direction[i], event.direction);
        squares += angle * angle;
      }
    }
    event.dispersion_deg = std::sqrt(squares / count) * kDegPerRad;
    event.peak_velocity_deg_s = peak_speed(event);
  }

  // A saccade goes from the last place before it to the first place after it, where these are its direct neighbours.
  void measure_saccade(EyeEvent& event) const {
    std::size_t from = event.first;
    std::size_t to = event.last;
    if (from > 0 && is_seen(gaze_.direction[from - 1]) && gaze_.t_ns[from] - gaze_.t_ns[from - 1] <= break_ns_) {
      --from;
    }
    if (to + 1 < gaze_.t_ns.size() && is_seen(gaze_.direction[to + 1]) &&
        gaze_.t_ns[to + 1] - gaze_.t_ns[to] <= break_ns_) {
      ++to;
    }
    while (from < to && !is_seen(gaze_.direction[from])) {
      ++from;
    }
    while (to > from && !is_seen(gaze_.direction[to])) {
      --to;
    }
    if (from == to) {
      return;
    }
    const Vec3d& a = gaze_.direction[from];
    const Vec3d& b = gaze_.direction[to];
    event.amplitude_deg = angle_between_rad(a, b) * kDegPerRad;
    const TangentFrame frame(a);
    event.angle_deg = std::atan2(dot(b, frame.up), dot(b, frame.right)) * kDegPerRad;
    event.peak_velocity_deg_s = peak_speed(event);
    event.mean_velocity_deg_s = mean_speed(event);
  }

  const GazeLog& log_;
  const GazeDirections& gaze_;
  std::int64_t break_ns_;
  std::vector<double> speed_;
};

}  // namespace

std::vector<EyeEvent> measure_events(const GazeLog& log, const GazeDirections& gaze, const EyeEvents& labelled) {
  const Measures measures(log, gaze, labelled.settings);
  std::vector<EyeEvent> events;
  auto cut = labelled.cuts.begin();
  for (LabelRun run : label_runs(labelled.labels, gaze.t_ns)) {
    const std::size_t last = run.last;
    cut = std::upper_bound(cut, labelled.cuts.end(), run.first);
    for (; cut != labelled.cuts.end() && *cut <= last; ++cut) {
      run.last = *cut - 1;
      events.push_back(measures.event(run));
      run.first = *cut;
    }
    run.last = last;
    events.push_back(measures.event(run));
  }
  return events;
}

}  // namespace gazetrace
