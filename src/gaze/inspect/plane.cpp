// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gaze/inspect/inspect.hpp"

namespace gazetrace {
namespace {

constexpr double kAssumedWidthDeg = 40;  // of a picture of unknown size, for thresholds alone

}  // namespace

GazePlane::GazePlane(const GazeLog& log, const std::optional<DisplayGeometry>& given)
    : is_direction_(log.kind == GazeKind::direction) {
  if (is_direction_) {
    return;
  }
  DisplayGeometry g = log.kind == GazeKind::screen ? given.value_or(DisplayGeometry{}) : DisplayGeometry{};
  if (const auto& stated = log.recording_geometry; stated && log.kind == GazeKind::screen) {
    g.width_px = g.width_px > 0 ? g.width_px : stated->width_px;
    g.height_px = g.height_px > 0 ? g.height_px : stated->height_px;
    if (!(g.width_cm > 0 && g.height_cm > 0)) {
      g.width_cm = stated->width_cm;
      g.height_cm = stated->height_cm;
    }
    g.distance_cm = g.distance_cm > 0 ? g.distance_cm : stated->distance_cm;
    if (g.eye_x_cm == 0 && g.eye_y_cm == 0) {  // what was given about the eye is already in the log
      g.eye_x_cm = stated->eye_x_cm;
      g.eye_y_cm = stated->eye_y_cm;
    }
  }
  screen_ = ScreenAngles(g, log.pixels_per_degree);
  if (screen_.known_by_size()) {
    return;
  }
  if (log.pixels_per_degree && g.width_px > 0 && g.height_px > 0) {
    x_scale_ = g.width_px / log.pixels_per_degree->x;
    y_scale_ = g.height_px / log.pixels_per_degree->y;
  } else if (g.width_px > 0 && g.height_px > 0) {
    unit_ = "px";
    x_scale_ = g.width_px;
    y_scale_ = g.height_px;
    units_per_degree_ = g.width_px / kAssumedWidthDeg;
  } else {
    unit_ = "of the picture";
    units_per_degree_ = 1 / kAssumedWidthDeg;
  }
}

Vec2d GazePlane::at(const Vec3d& place) const {
  if (is_direction_) {
    return {std::atan2(place.x, -place.z) * kDegPerRad,
            std::atan2(place.y, std::sqrt(place.x * place.x + place.z * place.z)) * kDegPerRad};
  }
  if (screen_.known_by_size()) {
    const Vec2d angles = screen_.angles(place.x, place.y);
    return {angles.x * kDegPerRad, angles.y * kDegPerRad};
  }
  return {place.x * x_scale_, -place.y * y_scale_};
}

}  // namespace gazetrace
