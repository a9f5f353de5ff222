// SPDX-License-Identifier: Apache-2.0
#include "gaze/angles.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {
Quatd HeadWalker::orientation(std::int64_t t_ns) {
  while (at_ + 1 < head_.size() && head_[at_ + 1].t_ns <= t_ns) {
    ++at_;
  }
  const HeadPose& a = head_[at_];
  if (at_ + 1 == head_.size() || t_ns <= a.t_ns) {
    return a.orientation;
  }
  const HeadPose& b = head_[at_ + 1];
  return slerp(a.orientation, b.orientation, static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns));
}

Vec3d between_directions(const Vec3d& a, const Vec3d& b, double s) {
  const double angle = angle_between_rad(a, b);
  const double sine = std::sin(angle);
  if (!(sine > 1e-9)) {  // the same direction, or opposite ones, which no single arc joins
    return s < 0.5 ? a : b;
  }
  return normalize(a * (std::sin((1.0 - s) * angle) / sine) + b * (std::sin(s * angle) / sine));
}

std::int64_t median_step_ns(const std::vector<std::int64_t>& t_ns) {
  if (t_ns.size() < 2) {
    return 0;
  }
  std::vector<std::int64_t> steps(t_ns.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = t_ns[i + 1] - t_ns[i];
  }
  return upper_median(steps);
}

std::vector<std::int64_t> times_of(const GazeLog& log) {
  std::vector<std::int64_t> t_ns(log.samples.size());
  std::transform(log.samples.begin(), log.samples.end(), t_ns.begin(), [](const GazeSample& s) { return s.t_ns; });
  return t_ns;
}

std::int64_t break_step_ns(std::int64_t median_step_ns) {
  return std::max<std::int64_t>(75'000'000, 3 * median_step_ns);
}

bool knows_angles(const GazeLog& log) {
  return log.kind == GazeKind::direction || (log.kind == GazeKind::screen && ScreenAngles(log).known());
}

GazeDirections gaze_directions(const GazeLog& log, GazeSpace space) {
  if (log.kind == GazeKind::scene_camera) {
    throw Error(ErrorKind::input, log.source, "gaze on a scene camera's picture has no angles",
                "use `frame` head, or a log mapped to a surface");
  }
  const ScreenAngles screen(log);
  if (log.kind == GazeKind::screen && !screen.known()) {
    const bool states_px = log.recording_geometry && log.recording_geometry->width_px > 0;
    throw Error(ErrorKind::input, log.source, "gaze on a screen means no angle without the screen's size and distance",
                fmt::format("give `screen` NAME, or {}`screen-cm` W,H `screen-distance-cm` D",
                            states_px ? "" : "`screen-px` W,H "));
  }
  if (space == GazeSpace::world && log.head.empty()) {
    throw Error(ErrorKind::input, log.source, "gaze in the world needs the head's pose, and the log has none",
                "use a method that works in the head: ivt-attention or adaptive-hmd");
  }
  HeadWalker head(log.head);
  GazeDirections gaze;
  gaze.t_ns = times_of(log);
  gaze.direction.reserve(log.samples.size());
  for (const GazeSample& sample : log.samples) {
    Vec3d direction{kNan, kNan, kNan};
    if (is_usable(sample.validity)) {
      const Vec3d given =
          log.kind == GazeKind::direction ? normalize(sample.direction) : screen.direction(sample.u, sample.v);
      if (is_finite(given) && length(given) > 0.5) {
        direction = space == GazeSpace::world ? rotate(head.orientation(sample.t_ns), given) : given;
      }
    }
    gaze.direction.push_back(direction);
  }
  return gaze;
}

std::vector<double> angular_speed_deg_s(const GazeDirections& gaze, std::int64_t window_ns) {
  const std::size_t count = gaze.t_ns.size();
  const std::int64_t break_ns = break_step_ns(median_step_ns(gaze.t_ns));
  std::vector<double> speed(count, kNan);
  const std::int64_t half_ns = window_ns / 2;
  for (std::size_t run = 0; run < count;) {
    if (!is_seen(gaze.direction[run])) {
      ++run;
      continue;
    }
    std::size_t end = run + 1;
    while (end < count && is_seen(gaze.direction[end]) && gaze.t_ns[end] - gaze.t_ns[end - 1] <= break_ns) {
      ++end;
    }
    std::size_t first = run;
    std::size_t last = run;
    for (std::size_t i = run; i < end; ++i) {
      while (first + 1 < i && gaze.t_ns[i] - gaze.t_ns[first] > half_ns) {
        ++first;
      }
      last = std::max(last, std::min(i + 1, end - 1));
      while (last + 1 < end && gaze.t_ns[last + 1] - gaze.t_ns[i] <= half_ns) {
        ++last;
      }
      if (last > first && gaze.t_ns[last] > gaze.t_ns[first]) {
        speed[i] = angle_between_rad(gaze.direction[first], gaze.direction[last]) * kDegPerRad /
                   (static_cast<double>(gaze.t_ns[last] - gaze.t_ns[first]) * 1e-9);
      }
    }
    run = end;
  }
  return speed;
}

}  // namespace gazetrace
