// SPDX-License-Identifier: Apache-2.0
// Small angles around a direction, in which means, extents and medians of directions are computed.
#pragma once

#include <cmath>
#include <cstdint>
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

}  // namespace gazetrace
