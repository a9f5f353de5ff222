// SPDX-License-Identifier: Apache-2.0
// What gaze on the screen of a recording is as an angle: the one place where a place on a screen becomes a direction.
#pragma once

#include <optional>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// How u, v of a screen become directions and angles from the eye, and back. They are known by the screen's size and
// distance, or by its pixels and how many of them a degree at its centre has.
class ScreenAngles {
 public:
  ScreenAngles() = default;  // of a screen of which nothing is known
  explicit ScreenAngles(const GazeLog& log);
  ScreenAngles(const DisplayGeometry& screen, const std::optional<Vec2d>& pixels_per_degree);

  [[nodiscard]] bool known() const { return width_ > 0; }
  [[nodiscard]] bool known_by_size() const { return has_size_; }

  [[nodiscard]] Vec3d direction(double u, double v) const {
    return normalize(Vec3d{(u - 0.5) * width_ - eye_x_, (0.5 - v) * height_ - eye_y_, -1});
  }
  // {NaN, NaN} for directions that never meet the screen.
  [[nodiscard]] Vec2d place(const Vec3d& direction) const;

  // Azimuth to the right and elevation, in radians. By pixels per degree alone they are taken as even over the screen
  // and count from its top left corner: good for differences.
  [[nodiscard]] Vec2d angles(double u, double v) const;
  [[nodiscard]] Vec2d place_at(const Vec2d& angles) const;  // u, v

 private:
  double width_ = 0, height_ = 0, eye_x_ = 0, eye_y_ = 0;  // at distance 1
  bool has_size_ = false;
  DisplayGeometry screen_;
  Vec2d degrees_;  // of the whole screen, where its size is not known
};

}  // namespace gazetrace
