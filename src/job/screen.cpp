// SPDX-License-Identifier: Apache-2.0
// Where the viewer sat, and which screen a recording was made on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/error.hpp"
#include "job/screen.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void usage(const std::string& place, const std::string& problem, const std::string& remedy = {}) {
  throw Error(ErrorKind::usage, place, problem, remedy);
}

void set_pixels_per_degree(const ScreenSettings& screen, DisplayGeometry& geometry) {
  const double ppd = *screen.pixels_per_degree;
  if (!(ppd > 0) || !std::isfinite(ppd)) {
    usage("`screen-ppd`", fmt::format("{} pixels a degree are not a positive number", ppd));
  }
  if (screen.size_cm || screen.distance_cm) {
    usage("`screen-ppd`", "it stands for the screen's size and distance",
          "leave out `screen-cm` and `screen-distance-cm`");
  }
  if (geometry.width_px <= 0 || geometry.height_px <= 0) {
    usage("`screen-ppd`", "the screen's pixels are not known", "give `screen-px` as well");
  }
  geometry = display_of_pixels_per_degree(geometry.width_px, geometry.height_px, {ppd, ppd});
}

}  // namespace

DisplayGeometry known_screen(const std::string& name, const std::string& option) {
  if (name.ends_with(".json")) {
    return load_display(name);
  }
  std::vector<std::string> known;
  for (const NamedDisplay& display : named_displays()) {
    known.push_back(display.name);
  }
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    usage(option, unknown_name_message("screen", name, known));
  }
  return display_by_name(name);
}

std::optional<DisplayGeometry> screen_geometry(const ScreenSettings& screen) {
  const bool any = screen.size_px || screen.size_cm || screen.distance_cm || screen.eye_cm || screen.pixels_per_degree;
  if (screen.name.empty() && !any) {
    return std::nullopt;
  }
  DisplayGeometry geometry;
  if (!screen.name.empty()) {
    geometry = known_screen(screen.name, "`screen`");
  }
  if (screen.size_px) {
    const Vec2d& px = *screen.size_px;
    if (px.x != std::floor(px.x) || px.y != std::floor(px.y) || std::abs(px.x) > 1e6 || std::abs(px.y) > 1e6) {
      usage("`screen-px`", "a resolution is two whole numbers, such as 3840,2160");
    }
    geometry.width_px = static_cast<int>(px.x);
    geometry.height_px = static_cast<int>(px.y);
  }
  if (screen.size_cm) {
    geometry.width_cm = screen.size_cm->x;
    geometry.height_cm = screen.size_cm->y;
  }
  geometry.distance_cm = screen.distance_cm.value_or(geometry.distance_cm);
  if (screen.pixels_per_degree) {
    set_pixels_per_degree(screen, geometry);
  }
  if (screen.eye_cm) {
    geometry.eye_x_cm = screen.eye_cm->x;
    geometry.eye_y_cm = screen.eye_cm->y;
  }
  const auto negative = [](double value) { return !(value >= 0) || !std::isfinite(value); };
  if (geometry.width_px < 0 || geometry.height_px < 0 || negative(geometry.width_cm) || negative(geometry.height_cm) ||
      negative(geometry.distance_cm)) {
    check_display(geometry);  // the error names the value
  }
  return geometry;
}

}  // namespace gazetrace
