// SPDX-License-Identifier: Apache-2.0
// Gaze on the screen of a recording as an angle. This is the one place in the code where a place on a screen becomes a
// direction.
#pragma once

#include <optional>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Converts u, v of a screen to directions and angles from the eye, and back. This needs the screen's size and distance,
// or its size in pixels and the pixels per degree at its centre.
class ScreenAngles {
 public:
  ScreenAngles() = default;  // for a screen about which nothing is known
  explicit ScreenAngles(const GazeLog& log);
  ScreenAngles(const DisplayGeometry& screen, const std::optional<Vec2d>& pixels_per_degree);

  [[nodiscard]] bool known() const { return width_ > 0; }
  [[nodiscard]] bool known_by_size() const { return has_size_; }

  [[nodiscard]] Vec3d direction(double u, double v) const {
    return normalize(Vec3d{(u - 0.5) * width_ - eye_x_, (0.5 - v) * height_ - eye_y_, -1});
  }
  // {NaN, NaN} for directions that never meet the screen.
  [[nodiscard]] Vec2d place(const Vec3d& direction) const;

  // Azimuth (positive to the right) and elevation, in radians. Where only pixels per degree are known, the angles are
  // taken as uniform over the screen and count from its top left corner, which is good enough for differences.
  [[nodiscard]] Vec2d angles(double u, double v) const;
  [[nodiscard]] Vec2d place_at(const Vec2d& angles) const;  // u, v

 private:
  double width_ = 0, height_ = 0, eye_x_ = 0, eye_y_ = 0;  // at distance 1
  bool has_size_ = false;
  DisplayGeometry screen_;
  Vec2d degrees_;  // extent of the whole screen, where its size is not known
};

}  // namespace gazetrace
