// SPDX-License-Identifier: Apache-2.0
// Where the eye was: the scanpath and the heat map, over a picture where there is one.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/statistics.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gazelog/screen_angles.hpp"
#include "gazetrace/gaze_event_durations.hpp"
#include "study/report/drawing.hpp"
#include "study/report/heat.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostNumbers = 60;

// What the plane of the plot is: the display in fractions, or angles around straight ahead.
struct Plane {
  bool is_screen = false;
  Axis x, y;
  double height = 0;  // of the drawing
};

Vec2d place_of(const EyeEvent& event, bool is_screen) {
  if (is_screen) {
    return {event.u, event.v};
  }
  const Vec3d& d = event.direction;
  return {std::atan2(d.x, -d.z) * kDegPerRad, std::atan2(d.y, std::hypot(d.x, d.z)) * kDegPerRad};
}

std::vector<const EyeEvent*> placed_fixations(const std::vector<EyeEvent>& events, bool is_screen) {
  std::vector<const EyeEvent*> fixations;
  for (const EyeEvent& event : events) {
    const Vec2d at = place_of(event, is_screen);
    if (event.movement == EyeMovement::fixation && std::isfinite(at.x) && std::isfinite(at.y)) {
      fixations.push_back(&event);
    }
  }
  return fixations;
}

double aspect_of(const GazeLog& log) {
  const auto& g = log.recording_geometry;
  return g && g->width_px > 0 && g->height_px > 0 ? static_cast<double>(g->height_px) / g->width_px : 9.0 / 16;
}

Plane plane_of(const GazeLog& log, const std::vector<const EyeEvent*>& fixations) {
  Plane plane;
  plane.is_screen = log.kind != GazeKind::direction;
  const double width = kWideWidth - 2 * kHeatMargin;
  if (plane.is_screen) {
    const double height = width * aspect_of(log);
    plane.x = {0, 1, kHeatMargin, kHeatMargin + width};
    plane.y = {0, 1, kHeatMargin, kHeatMargin + height};
    plane.height = height + kHeatMargin + kBelowHeat;
    return plane;
  }
  double reach = 5;
  for (const EyeEvent* f : fixations) {
    const Vec2d at = place_of(*f, false);
    reach = std::max({reach, std::abs(at.x), std::abs(at.y)});
  }
  reach = std::min(reach * 1.08, 90.0);
  const double height = 0.62 * width;
  plane.x = {-reach / 0.62, reach / 0.62, kHeatMargin, kHeatMargin + width};
  plane.y = {reach, -reach, kHeatMargin, kHeatMargin + height};
  plane.height = height + kHeatMargin + kBelowHeat;
  return plane;
}

void draw_ground(Drawing& svg, const Plane& plane, const std::string& picture, double darken) {
  const double width = plane.x.end - plane.x.begin;
  const double height = plane.y.end - plane.y.begin;
  svg.add(fmt::format(R"(<rect x="{0}" y="{0}" width="{1:.1f}" height="{2:.1f}" fill="#f2f2ef" stroke="#888888"/>)",
                      kHeatMargin, width, height));
  if (!picture.empty() && plane.is_screen) {
    svg.add(fmt::format(
        R"(<image x="{0}" y="{0}" width="{1:.1f}" height="{2:.1f}" preserveAspectRatio="none" href="{3}"/>)",
        kHeatMargin, width, height, picture));
    svg.add(fmt::format(R"(<rect x="{0}" y="{0}" width="{1:.1f}" height="{2:.1f}" fill="#000000" fill-opacity="{3}"/>)",
                        kHeatMargin, width, height, darken));
  }
}

std::string beside_note(const std::vector<const EyeEvent*>& fixations, const Plane& plane) {
  const auto beside = std::count_if(fixations.begin(), fixations.end(), [&](const EyeEvent* f) {
    const Vec2d at = place_of(*f, plane.is_screen);
    return plane.is_screen && (at.x < 0 || at.y < 0 || at.x > 1 || at.y > 1);
  });
  return beside > 0 ? fmt::format("; {} beside the display are not shown", beside) : "";
}

HeatGrid heat_of(const std::vector<const EyeEvent*>& fixations, const ScreenAngles& screen, double aspect,
                 double sigma_deg, std::int64_t step_ns) {
  HeatGrid grid;
  grid.rows =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::round(static_cast<double>(grid.columns) * aspect)));
  grid.values.assign(grid.columns * grid.rows, 0.0);
  const double sigma = sigma_deg * kRadPerDeg;
  const double peak = 1 / (2 * kPi * sigma_deg * sigma_deg);
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      const Vec3d direction = screen.direction((static_cast<double>(column) + 0.5) / static_cast<double>(grid.columns),
                                               (static_cast<double>(row) + 0.5) / static_cast<double>(grid.rows));
      double& value = grid.values[row * grid.columns + column];
      for (const EyeEvent* f : fixations) {
        // For small angles the square of the angle is that of the chord, which needs no trigonometry.
        const Vec3d apart = direction - f->direction;
        const double squares = dot(apart, apart) / (sigma * sigma);
        if (squares < 18) {
          value += static_cast<double>(event_duration_ns(*f, step_ns)) * 1e-9 * peak * std::exp(-0.5 * squares);
        }
      }
      grid.highest = std::max(grid.highest, value);
    }
  }
  return grid;
}

}  // namespace

GazePlot scanpath_plot(const GazeLog& log, const std::vector<EyeEvent>& events, const std::string& picture) {
  const bool is_screen = log.kind != GazeKind::direction;
  const std::vector<const EyeEvent*> fixations = placed_fixations(events, is_screen);
  const Plane plane = plane_of(log, fixations);
  const std::int64_t step_ns = event_step_ns(log);
  Drawing svg(kWideWidth, plane.height, "Scanpath: fixations in their order, larger where they last longer");
  draw_ground(svg, plane, picture, 0.25);
  svg.add(
      fmt::format(R"(<clipPath id="scanpath-clip"><rect x="{0}" y="{0}" width="{1:.1f}" height="{2:.1f}"/></clipPath>)",
                  kHeatMargin, plane.x.end - plane.x.begin, plane.y.end - plane.y.begin));
  svg.add(fmt::format(R"-(<g clip-path="url(#scanpath-clip)">)-"));
  const bool on_picture = !picture.empty() && is_screen;
  std::string path;
  for (const EyeEvent* f : fixations) {
    const Vec2d at = place_of(*f, is_screen);
    fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", path.empty() ? "M" : "L", plane.x.at(at.x),
                   plane.y.at(at.y));
  }
  svg.add(fmt::format(
      R"(<path d="{}" fill="none" stroke="{}" stroke-width="1.2" stroke-opacity="0.7" stroke-linejoin="round"/>)", path,
      on_picture ? "#ffffff" : "#555555"));
  for (std::size_t i = 0; i < fixations.size(); ++i) {
    const Vec2d at = place_of(*fixations[i], is_screen);
    const double seconds = static_cast<double>(event_duration_ns(*fixations[i], step_ns)) * 1e-9;
    const double radius = std::clamp(16 * std::sqrt(seconds), 3.0, 30.0);
    svg.add(fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" fill="{}" fill-opacity="0.5" stroke="{}"/>)",
                        plane.x.at(at.x), plane.y.at(at.y), radius, on_picture ? "#ffd34d" : "#56b4e9",
                        on_picture ? "#4a3600" : "#0a3d62"));
    if (i < kMostNumbers) {
      svg.text(plane.x.at(at.x), plane.y.at(at.y) + 4, std::to_string(i + 1), "middle",
               R"(font-size="11" font-weight="bold" fill="#111111")");
    }
  }
  svg.add(fmt::format("</g>"));
  std::string note = fmt::format("{} fixations in their order, area by duration", fixations.size());
  if (fixations.size() > kMostNumbers) {
    note += fmt::format("; the first {} are numbered", kMostNumbers);
  }
  note += is_screen ? beside_note(fixations, plane)
                    : fmt::format("; {:.0f} degrees from the middle to the upper edge", plane.y.low);
  svg.text(kHeatMargin, plane.y.end + 24, note);
  return {"scanpath", "Scanpath", svg.str(), true, note};
}

std::optional<GazePlot> heat_map_plot(const GazeLog& log, const std::vector<EyeEvent>& events,
                                      const std::string& picture, double sigma_deg) {
  const ScreenAngles screen(log);
  const std::vector<const EyeEvent*> fixations = placed_fixations(events, true);
  if (log.kind != GazeKind::screen || !screen.known() || fixations.empty()) {
    return std::nullopt;
  }
  const Plane plane = plane_of(log, fixations);
  Drawing svg(kWideWidth, plane.height, "Heat map: where fixations spent their time");
  draw_ground(svg, plane, picture, 0.35);
  const HeatGrid grid = heat_of(fixations, screen, aspect_of(log), sigma_deg, event_step_ns(log));
  if (grid.highest > 0) {
    draw_heat(svg, grid, plane.x, plane.y, "s of fixation per square degree");
  }
  const std::string note = fmt::format("each fixation a spot of {:.2g} deg (standard deviation)", sigma_deg);
  svg.text(plane.x.end, plane.y.end + 25, note, "end");
  return GazePlot{"heat_map", "Heat map of fixation time", svg.str(), true,
                  fmt::format("Colors from {:.2g} to {:.2g} s of fixation per square degree; {}", lowest_drawn(grid),
                              grid.highest, note)};
}

}  // namespace gazetrace
