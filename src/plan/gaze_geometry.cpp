// SPDX-License-Identifier: Apache-2.0
#include "plan/gaze_geometry.hpp"

#include <fmt/format.h>

#include <cmath>

namespace gazetrace {
namespace {

constexpr double kSameSize = 0.02;  // relative difference of size over distance that still counts as the same

const DisplayGeometry& display_for_screen_log(const GazeLog& log, const PlanSettings& settings) {
  constexpr std::string_view kRemedy = "give `screen` NAME, or `screen-px` W,H `screen-cm` W,H `screen-distance-cm` D";
  if (!settings.display) {
    throw Error(ErrorKind::input, log.source,
                "gaze on a screen cannot be turned into angles without the screen's size and distance", kRemedy);
  }
  try {
    check_display(*settings.display);
  } catch (const Error& error) {
    throw Error(ErrorKind::input, log.source,
                fmt::format("gaze on a screen cannot be turned into angles: {}", error.what()), kRemedy);
  }
  return *settings.display;
}

double width_deg(const DisplayGeometry& display) {
  return 2.0 * std::atan2(0.5 * display.width_cm, display.distance_cm) * kDegPerRad;
}

void warn_about_pixels(const DisplayGeometry& display, Warnings& warnings) {
  const double square = (display.height_cm / display.height_px) / (display.width_cm / display.width_px);
  if (std::abs(square - 1.0) > 0.01) {
    warnings.push_back(fmt::format("the display's pixels are not square: height to width {:.3f}", square));
  }
}

// Only the ratios of the size to the distance matter, so pixels may be missing.
bool is_complete(const std::optional<DisplayGeometry>& g) {
  return g && g->width_cm > 0 && g->height_cm > 0 && g->distance_cm > 0;
}

// The recording's screen as far as angles on it are known, by size and distance or by pixels per degree.
std::optional<DisplayGeometry> recording_screen(const GazeLog& log) {
  if (is_complete(log.recording_geometry)) {
    return log.recording_geometry;
  }
  const auto& g = log.recording_geometry;
  const auto& ppd = log.pixels_per_degree;
  if (g && g->width_px > 0 && g->height_px > 0 && ppd && ppd->x > 0 && ppd->y > 0) {
    return display_of_pixels_per_degree(g->width_px, g->height_px, *ppd);
  }
  return std::nullopt;
}

bool same_place(const DisplayGeometry& a, const DisplayGeometry& b) {
  const auto close = [](double x, double y, double scale) { return std::abs(x - y) <= kSameSize * scale; };
  const double width = b.width_cm / b.distance_cm;
  const double height = b.height_cm / b.distance_cm;
  return close(a.width_cm / a.distance_cm, width, width) && close(a.height_cm / a.distance_cm, height, height) &&
         close(a.eye_x_cm / a.distance_cm, b.eye_x_cm / b.distance_cm, width) &&
         close(a.eye_y_cm / a.distance_cm, b.eye_y_cm / b.distance_cm, height);
}

// The recording's screen where gaze is carried over by angle; empty where positions are kept.
std::optional<DisplayGeometry> transfer(const GazeLog& log, const DisplayGeometry& display,
                                        const std::optional<GazeTransfer>& how, Warnings& warnings) {
  const std::optional<DisplayGeometry> known = recording_screen(log);
  if (!known) {
    if (how == GazeTransfer::angle) {
      throw Error(ErrorKind::input, log.source, "the size and distance of the recording's screen are not known",
                  "give `recording-screen` to carry gaze over by angle");
    }
    return std::nullopt;
  }
  const DisplayGeometry& recording = *known;
  if (same_place(recording, display)) {
    return std::nullopt;
  }
  const double gain = (display.width_cm / display.distance_cm) / (recording.width_cm / recording.distance_cm);
  const std::string what = fmt::format("recorded on a display {:.1f} deg wide and shown on one {:.1f} deg wide",
                                       width_deg(recording), width_deg(display));
  if (!how) {
    throw Error(ErrorKind::input, log.source, what,
                fmt::format("choose with `gaze-transfer`: fraction keeps positions on the display (angles near its "
                            "center change by a factor of {:.2f}), angle keeps angles; or, where the log states its "
                            "display wrongly, say with `recording-screen` which it was",
                            gain));
  }
  if (*how == GazeTransfer::fraction) {
    warnings.push_back(
        fmt::format("{}: {}; gaze is carried over as a fraction of the display, so angles near its "
                    "center change by a factor of {:.2f}",
                    log.source, what, gain));
    return std::nullopt;
  }
  warnings.push_back(
      fmt::format("{}: {}; gaze is carried over by angle, so distances on the display change by a "
                  "factor of {:.2f}",
                  log.source, what, 1 / gain));
  DisplayGeometry screen = recording;
  if (screen.width_px <= 0 || screen.height_px <= 0) {
    screen.width_px = screen.height_px = 1;  // only fractions of it are used
  }
  return screen;
}

}  // namespace

GazeGeometry::GazeGeometry(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings,
                           Warnings& warnings) {
  const bool directions = log != nullptr && log->kind == GazeKind::direction;
  if (directions && camera.projection.kind != ProjectionKind::perspective) {
    throw Error(ErrorKind::input, log->source,
                "gaze directions need a perspective camera: an orthographic one has no eye",
                "use a perspective camera, or a log of gaze on a screen");
  }
  if (log != nullptr && log->kind == GazeKind::scene_camera) {
    throw Error(ErrorKind::input, log->source,
                "gaze on a scene camera's picture is neither a position on a display nor a direction from the eye",
                "use a log mapped to a surface, or `frame` head");
  }
  const bool on_screen = log != nullptr && !directions;
  if (on_screen) {
    display_for_screen_log(*log, settings);
  }
  if (settings.display && !directions) {
    const DisplayGeometry& display = *settings.display;
    view_ = view_of_display(display, settings.frame_rect, settings.width_px, settings.height_px);
    screen_ = view_of_display(display, {}, display.width_px, display.height_px);
    warn_about_pixels(display, warnings);
    if (on_screen) {
      if (const auto recording = transfer(*log, display, settings.transfer, warnings)) {
        recording_ = view_of_display(*recording, {}, recording->width_px, recording->height_px);
      }
    }
  } else {
    if (settings.display) {
      warnings.push_back(fmt::format("{}: gaze directions need no display; the given one is not used", log->source));
    }
    // Without a display the camera's own frustum is the view. An orthographic camera has none and gets the default one.
    const Projection projection =
        camera.projection.kind == ProjectionKind::perspective ? camera.projection : Projection{};
    view_ = view_of_perspective(projection.yfov_rad, settings.width_px, settings.height_px);
    view_.left += projection.middle_m.x;
    view_.top += projection.middle_m.y;
  }
}

void GazeGeometry::settle(GazeAtTime& gaze) const {
  const bool is_center = gaze.state == GazeState::center;
  if (gaze.state == GazeState::none || (!is_center && !recording_)) {
    return;
  }
  // This is the center of the frame, which need not fill the display.
  const Vec3d direction = is_center
                              ? normalize(view_.direction(0.5 * view_.width_px, 0.5 * view_.height_px))
                              : recording_->direction(gaze.u * recording_->width_px, gaze.v * recording_->height_px);
  if (is_center) {
    gaze.direction = direction;
  }
  if (gaze.kind == GazeKind::screen) {
    const Vec2d pixel = screen_.pixel(direction);
    gaze.u = pixel.x / screen_.width_px;
    gaze.v = pixel.y / screen_.height_px;
  }
}

std::optional<Vec3d> GazeGeometry::direction(const GazeAtTime& gaze) const {
  if (gaze.state == GazeState::none) {
    return std::nullopt;
  }
  if (gaze.kind == GazeKind::direction || gaze.state == GazeState::center) {
    return gaze.direction;
  }
  return normalize(screen_.direction(gaze.u * screen_.width_px, gaze.v * screen_.height_px));
}

}  // namespace gazetrace
