// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/display.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/nan.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

void check_positive(double value, std::string_view field, std::string_view remedy) {
  if (value == 0) {
    throw Error(ErrorKind::usage, "", fmt::format("the display's {} is not stated", field), remedy);
  }
  if (!std::isfinite(value) || value < 0) {
    throw Error(ErrorKind::usage, "", fmt::format("the display's {} is {}, not a positive number", field, value),
                remedy);
  }
}

// Rounding a size to whole pixels may cost half a pixel in one of the two directions.
bool same_aspect(const FrameRect& rect, int width_px, int height_px) {
  const double wanted_height = width_px * rect.height_px / rect.width_px;
  const double wanted_width = height_px * rect.width_px / rect.height_px;
  return std::abs(wanted_height - height_px) <= 0.5 || std::abs(wanted_width - width_px) <= 0.5;
}

void check_frame_size(int width_px, int height_px) {
  if (width_px <= 0 || height_px <= 0) {
    throw Error(ErrorKind::usage, "", fmt::format("a frame of {}x{} px has no pixels", width_px, height_px));
  }
}

bool is_default(const FrameRect& rect) {
  return rect.x_px == 0 && rect.y_px == 0 && rect.width_px == 0 && rect.height_px == 0;
}

}  // namespace

void check_display(const DisplayGeometry& display) {
  check_positive(display.width_px, "width in pixels", "give `screen-px`, or `screen` with a name");
  check_positive(display.height_px, "height in pixels", "give `screen-px`, or `screen` with a name");
  check_positive(display.width_cm, "width in cm", "give `screen-cm`, the size of its active area");
  check_positive(display.height_cm, "height in cm", "give `screen-cm`, the size of its active area");
  check_positive(display.distance_cm, "distance from the eye in cm", "give `screen-distance-cm`");
  if (!std::isfinite(display.eye_x_cm) || !std::isfinite(display.eye_y_cm)) {
    throw Error(ErrorKind::usage, "", "the eye's offset from the display's centre is not a finite number",
                "give it in cm, right and up");
  }
}

DisplayGeometry display_of_pixels_per_degree(int width_px, int height_px, const Vec2d& pixels_per_degree) {
  constexpr double kDistanceCm = 100;
  const auto size_cm = [](int px, double ppd) { return px / ppd * kRadPerDeg * kDistanceCm; };
  return {.width_px = width_px,
          .height_px = height_px,
          .width_cm = size_cm(width_px, pixels_per_degree.x),
          .height_cm = size_cm(height_px, pixels_per_degree.y),
          .distance_cm = kDistanceCm};
}

double pixels_per_degree(const DisplayGeometry& display) {
  return display.distance_cm * kRadPerDeg * display.width_px / display.width_cm;
}

Vec2d PlanarView::pixel(const Vec3d& direction) const {
  if (!(direction.z < 0)) {
    return {kNan, kNan};
  }
  return {(direction.x / -direction.z - left) / step_x, (top - direction.y / -direction.z) / step_y};
}

PlanarView view_of_display(const DisplayGeometry& display, const FrameRect& rect, int frame_width_px,
                           int frame_height_px) {
  check_display(display);
  check_frame_size(frame_width_px, frame_height_px);
  const double display_width = display.width_px;
  const double display_height = display.height_px;
  const FrameRect r = is_default(rect) ? FrameRect{0, 0, display_width, display_height} : rect;
  if (!(r.width_px > 0) || !(r.height_px > 0) || !(r.x_px >= 0) || !(r.y_px >= 0) ||
      !(r.x_px + r.width_px <= display_width) || !(r.y_px + r.height_px <= display_height)) {
    throw Error(ErrorKind::usage, "",
                fmt::format("the frame's rectangle {}x{} at ({}, {}) px does not lie on the display of {}x{} px",
                            r.width_px, r.height_px, r.x_px, r.y_px, display.width_px, display.height_px));
  }
  if (!same_aspect(r, frame_width_px, frame_height_px)) {
    throw Error(ErrorKind::usage, "",
                fmt::format("a frame of {}x{} px does not have the shape of the {}x{} px of the display that it fills",
                            frame_width_px, frame_height_px, r.width_px, r.height_px),
                fmt::format("give `size` {:.0f}x{}, or say with `frame-rect` where on the display the frame lies",
                            std::max(1.0, std::round(frame_height_px * r.width_px / r.height_px)), frame_height_px));
  }
  const double cm_per_px_x = display.width_cm / display_width;
  const double cm_per_px_y = display.height_cm / display_height;
  PlanarView view;
  view.left = ((r.x_px - 0.5 * display_width) * cm_per_px_x - display.eye_x_cm) / display.distance_cm;
  view.top = ((0.5 * display_height - r.y_px) * cm_per_px_y - display.eye_y_cm) / display.distance_cm;
  view.step_x = r.width_px / frame_width_px * cm_per_px_x / display.distance_cm;
  view.step_y = r.height_px / frame_height_px * cm_per_px_y / display.distance_cm;
  view.width_px = frame_width_px;
  view.height_px = frame_height_px;
  return view;
}

PlanarView view_of_perspective(double yfov_rad, int frame_width_px, int frame_height_px) {
  check_frame_size(frame_width_px, frame_height_px);
  if (!(yfov_rad > 0) || !(yfov_rad < kPi)) {
    throw Error(ErrorKind::usage, "",
                fmt::format("a vertical field of view of {} degrees is not between 0 and 180", yfov_rad * kDegPerRad));
  }
  PlanarView view;
  view.top = std::tan(0.5 * yfov_rad);
  view.step_y = 2.0 * view.top / frame_height_px;
  view.step_x = view.step_y;
  view.left = -0.5 * frame_width_px * view.step_x;
  view.width_px = frame_width_px;
  view.height_px = frame_height_px;
  return view;
}

double eccentricity_deg(const PlanarView& view, const Vec3d& gaze_direction, double x_px, double y_px) {
  return angle_between_rad(gaze_direction, view.direction(x_px, y_px)) * kDegPerRad;
}

}  // namespace gazetrace
