// SPDX-License-Identifier: Apache-2.0
#include "gazelog/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace gazetrace {
namespace {

constexpr double kSameSize = 0.02;

bool differ(double a, double b) {
  return a > 0 && b > 0 && std::abs(a - b) > kSameSize * b;
}

bool has_angles(const DisplayGeometry& g) {
  return g.width_cm > 0 && g.height_cm > 0 && g.distance_cm > 0;
}

void warn_about_size(const RawGaze& raw, Conventions& c, const DisplayGeometry& given, const DisplayGeometry& stated) {
  if (stated.width_px > 0 && given.width_px > 0 &&
      (stated.width_px != given.width_px || stated.height_px != given.height_px)) {
    c.warnings.push_back(fmt::format("{}: the log states a display of {}x{} px; the given {}x{} px are used", raw.place,
                                     stated.width_px, stated.height_px, given.width_px, given.height_px));
  }
  if (differ(given.width_cm, stated.width_cm) || differ(given.height_cm, stated.height_cm)) {
    c.warnings.push_back(
        fmt::format("{}: the log states a display of {:.4g} x {:.4g} cm; the given {:.4g} x {:.4g} cm are used",
                    raw.place, stated.width_cm, stated.height_cm, given.width_cm, given.height_cm));
  }
  if (differ(given.distance_cm, stated.distance_cm)) {
    c.warnings.push_back(fmt::format("{}: the log states a distance of {:.4g} cm; the given {:.4g} cm are used",
                                     raw.place, stated.distance_cm, given.distance_cm));
  }
}

// `used` gives angles by what the user stated; the log may give them by its pixels per degree alone.
void warn_about_density(const RawGaze& raw, Conventions& c, const DisplayGeometry& used) {
  if (!raw.pixels_per_degree || !has_angles(used) || used.width_px <= 0 || used.height_px <= 0) {
    return;
  }
  const Vec2d& stated = *raw.pixels_per_degree;
  const double x = pixels_per_degree(used);
  const double y = used.distance_cm * kRadPerDeg * used.height_px / used.height_cm;
  if (differ(x, stated.x) || differ(y, stated.y)) {
    c.warnings.push_back(
        fmt::format("{}: the log states {:.4g} x {:.4g} pixels a degree; the given screen, which has {:.4g} x {:.4g}, "
                    "is used",
                    raw.place, stated.x, stated.y, x, y));
  }
}

// Size and distance give angles only together. Where the log gives angles by its pixels per degree, one of the two
// alone has no effect.
void warn_about_unused(const RawGaze& raw, Conventions& c, const GazeReadOptions& options,
                       const DisplayGeometry& used) {
  if (!raw.pixels_per_degree || has_angles(used)) {
    return;
  }
  const DisplayGeometry given = options.display.value_or(DisplayGeometry{});
  std::vector<std::string_view> parts;
  if (given.width_cm > 0 && given.height_cm > 0) {
    parts.emplace_back("the size in cm");
  }
  if (given.distance_cm > 0) {
    parts.emplace_back("the distance");
  }
  if (options.eye_cm || given.eye_x_cm != 0 || given.eye_y_cm != 0) {
    parts.emplace_back("the eye's place");
  }
  if (parts.empty()) {
    return;
  }
  const Vec2d& stated = *raw.pixels_per_degree;
  c.warnings.push_back(fmt::format(
      "{}: not used: {} of the screen that {} given, because angles are taken from the log's {:.4g} x {:.4g} "
      "pixels a degree; give `screen-cm` and `screen-distance-cm` both to overrule them",
      raw.place, fmt::join(parts, " and "), parts.size() > 1 ? "were" : "was", stated.x, stated.y));
}

// The eye's position beside the center is independent of its distance: giving another distance does not say that the
// eye is in front of the center.
void place_eye(const RawGaze& raw, Conventions& c, const GazeReadOptions& options, const DisplayGeometry& stated,
               DisplayGeometry& used) {
  const Vec2d own{stated.eye_x_cm, stated.eye_y_cm};
  const bool display_says = options.display && (options.display->eye_x_cm != 0 || options.display->eye_y_cm != 0);
  const Vec2d eye = options.eye_cm ? *options.eye_cm
                    : display_says ? Vec2d{options.display->eye_x_cm, options.display->eye_y_cm}
                                   : own;
  used.eye_x_cm = eye.x;
  used.eye_y_cm = eye.y;
  const double apart = std::max(std::abs(eye.x - own.x), std::abs(eye.y - own.y));
  if ((own.x != 0 || own.y != 0) && apart > kSameSize * stated.distance_cm) {
    c.warnings.push_back(fmt::format(
        "{}: the log states that the eye is {:.3g}, {:.3g} cm off the display's center (right, up); the given {:.3g}, "
        "{:.3g} cm are used",
        raw.place, own.x, own.y, eye.x, eye.y));
  }
}

}  // namespace

void settle_display(RawGaze& raw) {
  for (const CornerFromRow& corner : raw.corners) {
    if (corner.size_px[0] == 0 || !raw.recording_geometry || corner.first_row >= raw.rows.size()) {
      continue;
    }
    DisplayGeometry& g = *raw.recording_geometry;
    const bool is_other = corner.size_px != std::array<int, 2>{g.width_px, g.height_px};
    if (is_other && corner.first_row > 0) {
      const std::string problem = fmt::format("the display's size changes from {}x{} to {}x{} px", g.width_px,
                                              g.height_px, corner.size_px[0], corner.size_px[1]);
      raw.faults.push_back({"display-changes", fmt::format("{}:{}", raw.source, raw.rows[corner.first_row].row),
                            problem, "read one block at a time with `gaze-recording`, such as `gaze-recording` 1",
                            "`gaze-recording` 1", fmt::format("{}, line {}", problem, raw.rows[corner.first_row].row)});
      return;
    }
    g.width_px = corner.size_px[0];
    g.height_px = corner.size_px[1];
  }
}

DisplayGeometry completed_geometry(DisplayGeometry stated, const DisplayGeometry& by) {
  if (stated.width_px <= 0 || stated.height_px <= 0) {
    stated.width_px = by.width_px;
    stated.height_px = by.height_px;
  }
  if (!(stated.width_cm > 0) || !(stated.height_cm > 0)) {
    stated.width_cm = by.width_cm;
    stated.height_cm = by.height_cm;
  }
  if (!(stated.distance_cm > 0)) {
    stated.distance_cm = by.distance_cm;
    stated.eye_x_cm = by.eye_x_cm;
    stated.eye_y_cm = by.eye_y_cm;
  }
  return stated;
}

std::optional<Concluded<DisplayGeometry>> conversion_display(const RawGaze& raw, const GazeReadOptions& options,
                                                             Conventions& c) {
  const std::optional<DisplayGeometry>& stated = raw.recording_geometry;
  if (raw.kind == GazeKind::scene_camera) {
    if (raw.picture_px) {
      return Concluded<DisplayGeometry>{DisplayGeometry{.width_px = static_cast<int>(raw.picture_px->x),
                                                        .height_px = static_cast<int>(raw.picture_px->y)}};
    }
    return stated            ? std::optional(Concluded<DisplayGeometry>{*stated, Evidence::header})
           : options.display ? std::optional(Concluded<DisplayGeometry>{*options.display, Evidence::option})
                             : std::nullopt;
  }
  if (!options.display && !(options.eye_cm && stated)) {
    const std::optional<DisplayGeometry>& fallback = options.fallback_display;
    if (stated) {
      return Concluded<DisplayGeometry>{fallback ? completed_geometry(*stated, *fallback) : *stated, Evidence::header};
    }
    return fallback ? std::optional(Concluded<DisplayGeometry>{*fallback, Evidence::option}) : std::nullopt;
  }
  const DisplayGeometry given = options.display.value_or(DisplayGeometry{});
  const DisplayGeometry own = stated.value_or(DisplayGeometry{});
  DisplayGeometry used = completed_geometry(given, own);
  warn_about_size(raw, c, given, own);
  warn_about_density(raw, c, used);
  warn_about_unused(raw, c, options, used);
  place_eye(raw, c, options, own, used);
  c.recording_geometry = used;
  return Concluded<DisplayGeometry>{used, Evidence::option};
}

}  // namespace gazetrace
