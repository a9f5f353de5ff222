// SPDX-License-Identifier: Apache-2.0
// Small angles around a direction, in which means, extents and medians of directions are computed; and what else
// several files of this room need: the steps of the clock, the head and the events at a time, and times that nobody
// saw.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "gazelog/screen_angles.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// Axes around a direction: `right` is level and `up` points towards the world's +y. For directions straight up or down,
// where level has no meaning, -z counts as up.
struct TangentFrame {
  Vec3d right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};

  TangentFrame() = default;
  explicit TangentFrame(const Vec3d& direction) : forward(normalize(direction)) {
    const Vec3d level = cross(forward, Vec3d{0, 1, 0});
    right = length(level) > 1e-6 ? normalize(level) : Vec3d{1, 0, 0};
    up = cross(right, forward);
  }

  // Azimuth (positive to the right) and elevation, in radians.
  [[nodiscard]] Vec2d angles(const Vec3d& direction) const {
    const double x = dot(direction, right);
    const double z = dot(direction, forward);
    return {std::atan2(x, z), std::atan2(dot(direction, up), std::hypot(x, z))};
  }
  [[nodiscard]] Vec3d direction(const Vec2d& angles) const {
    const double level = std::cos(angles.y);
    return right * (std::sin(angles.x) * level) + up * std::sin(angles.y) + forward * (std::cos(angles.x) * level);
  }
};

// Poses of the head at increasing times, which are also asked for at increasing times.
class HeadWalker {
 public:
  explicit HeadWalker(const std::vector<HeadPose>& head) : head_(head) {}
  // Between two poses by slerp; before the first and after the last, theirs.
  Quatd orientation(std::int64_t t_ns);

 private:
  const std::vector<HeadPose>& head_;
  std::size_t at_ = 0;
};

inline bool is_seen(const Vec3d& direction) {
  return !std::isnan(direction.x);
}

// The direction between two others along the shorter arc, with s from 0 to 1.
Vec3d between_directions(const Vec3d& a, const Vec3d& b, double s);

// The median step between neighbouring samples; 0 for fewer than two samples.
std::int64_t median_step_ns(const std::vector<std::int64_t>& t_ns);
std::vector<std::int64_t> times_of(const GazeLog& log);

// A longer step between neighbours interrupts every event and filter: 75 ms, or three samples of a slow tracker.
std::int64_t break_step_ns(std::int64_t median_step_ns);

// The events of a log that fit, in the order of time.
template <class Fits>
std::vector<const GazeEvent*> events_in_time(const GazeLog& log, const Fits& fits) {
  std::vector<const GazeEvent*> events;
  for (const GazeEvent& event : log.events) {
    if (fits(event)) {
      events.push_back(&event);
    }
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const GazeEvent* a, const GazeEvent* b) { return a->begin_ns < b->begin_ns; });
  return events;
}

// Times of a log at which nobody saw what the eye did: in a gap, in a pause and after the end.

inline std::int64_t saturating_difference(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) {
    return a > b ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
  }
  return difference;
}

// Whether `row`, the last one that is not after the time, lies farther back than `max_gap_ns`, and so far that a row is
// missing at least, at the rate that the rows before it have. A log of one row stands for a gaze that never moves.
inline bool is_unseen(const std::vector<GazeSample>& samples, std::size_t row, std::int64_t t_ns,
                      std::int64_t max_gap_ns) {
  constexpr std::int64_t kSteps = 3;
  const std::int64_t step_ns = row > 0 ? saturating_difference(samples[row].t_ns, samples[row - 1].t_ns) : 0;
  const std::int64_t age_ns = saturating_difference(t_ns, samples[row].t_ns);
  return samples.size() > 1 && age_ns > max_gap_ns && age_ns / kSteps > step_ns;
}

}  // namespace gazetrace
