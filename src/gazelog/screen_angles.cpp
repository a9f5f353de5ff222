// SPDX-License-Identifier: Apache-2.0
#include "gazelog/screen_angles.hpp"
#include "core/nan.hpp"

#include <cmath>

namespace gazetrace {

ScreenAngles::ScreenAngles(const GazeLog& log) {
  if (log.kind == GazeKind::screen && log.recording_geometry) {
    *this = ScreenAngles(*log.recording_geometry, log.pixels_per_degree);
  }
}

ScreenAngles::ScreenAngles(const DisplayGeometry& screen, const std::optional<Vec2d>& pixels_per_degree)
    : screen_(screen) {
  const DisplayGeometry& g = screen_;
  if (g.width_cm > 0 && g.height_cm > 0 && g.distance_cm > 0) {
    has_size_ = true;
    width_ = g.width_cm / g.distance_cm;
    height_ = g.height_cm / g.distance_cm;
    eye_x_ = g.eye_x_cm / g.distance_cm;
    eye_y_ = g.eye_y_cm / g.distance_cm;
  } else if (pixels_per_degree && g.width_px > 0 && g.height_px > 0) {
    // A screen with this many pixels per degree at its centre is (pixels per degree) / tan(1 deg) pixels away.
    const double per_degree = std::tan(kRadPerDeg);
    width_ = g.width_px / pixels_per_degree->x * per_degree;
    height_ = g.height_px / pixels_per_degree->y * per_degree;
    degrees_ = {g.width_px / pixels_per_degree->x, g.height_px / pixels_per_degree->y};
  }
}

Vec2d ScreenAngles::place(const Vec3d& direction) const {
  if (!(direction.z < 0)) {
    return {kNan, kNan};
  }
  return {0.5 + (direction.x / -direction.z + eye_x_) / width_, 0.5 - (direction.y / -direction.z + eye_y_) / height_};
}

Vec2d ScreenAngles::angles(double u, double v) const {
  if (!has_size_) {
    return {u * degrees_.x * kRadPerDeg, -v * degrees_.y * kRadPerDeg};
  }
  const double right = (u - 0.5) * screen_.width_cm - screen_.eye_x_cm;
  const double up = (0.5 - v) * screen_.height_cm - screen_.eye_y_cm;
  const double d = screen_.distance_cm;
  return {std::atan2(right, d), std::atan2(up, std::sqrt(right * right + d * d))};
}

Vec2d ScreenAngles::place_at(const Vec2d& angles) const {
  if (!has_size_) {
    return {angles.x * kDegPerRad / degrees_.x, -angles.y * kDegPerRad / degrees_.y};
  }
  const double d = screen_.distance_cm;
  const double right = std::tan(angles.x) * d;
  return {0.5 + (right + screen_.eye_x_cm) / screen_.width_cm,
          0.5 - (std::tan(angles.y) * std::sqrt(right * right + d * d) + screen_.eye_y_cm) / screen_.height_cm};
}

}  // namespace gazetrace
