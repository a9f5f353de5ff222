// SPDX-License-Identifier: Apache-2.0
// The heat map on the surfaces of a scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "gazetrace/gaze_objects.hpp"
#include "study/report/heat.hpp"
#include "study/report/seen_surfaces.hpp"

namespace gazetrace {
namespace {

constexpr int kGreys = 12;

std::vector<GazeSpot> spots_of(const GazeObjects& objects, double frame_s, double sigma_deg) {
  std::vector<GazeSpot> spots;
  for (const FrameObjects& frame : objects.frames) {
    for (const RayHit& hit : frame.hits) {
      if (hit.object != 0) {
        spots.push_back({hit.position_m, hit.distance_m * std::tan(sigma_deg * kRadPerDeg),
                         frame_s / objects.settings.rays, hit.object});
      }
    }
  }
  return spots;
}

// Surfaces that are seen at a right angle are light. The normal comes from the places beside, where those lie on the
// same body.
void draw_surfaces(Drawing& svg, const std::vector<RayHit>& hits, const Vec3d& eye, std::size_t columns,
                   const Axis& x_axis, const Axis& y_axis) {
  const std::size_t rows = hits.size() / columns;
  const double cell_x = (x_axis.end - x_axis.begin) / static_cast<double>(columns);
  const double cell_y = (y_axis.end - y_axis.begin) / static_cast<double>(rows);
  const auto grey_at = [&](std::size_t row, std::size_t column) {
    const RayHit& hit = hits[row * columns + column];
    if (hit.object == 0) {
      return kGreys;  // the environment
    }
    const RayHit& beside = hits[row * columns + (column + 1 < columns ? column + 1 : column - 1)];
    const RayHit& below = hits[(row + 1 < rows ? row + 1 : row - 1) * columns + column];
    if (beside.object != hit.object || below.object != hit.object) {
      return 1;  // an outline
    }
    const Vec3d normal = cross(beside.position_m - hit.position_m, below.position_m - hit.position_m);
    const Vec3d towards = eye - hit.position_m;
    const double cosine = std::abs(dot(normal, towards)) / std::max(length(normal) * length(towards), 1e-300);
    return 2 + static_cast<int>(std::min(cosine, 0.999) * (kGreys - 2));
  };
  std::array<std::string, kGreys + 1> paths;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns;) {
      const int grey = grey_at(row, column);
      std::size_t end = column + 1;
      while (end < columns && grey_at(row, end) == grey) {
        ++end;
      }
      fmt::format_to(std::back_inserter(paths[static_cast<std::size_t>(grey)]), "M{:.1f} {:.1f}h{:.1f}v{:.2f}h{:.1f}z",
                     x_axis.begin + cell_x * static_cast<double>(column),
                     y_axis.begin + cell_y * static_cast<double>(row), cell_x * static_cast<double>(end - column),
                     cell_y + 0.05, -cell_x * static_cast<double>(end - column));
      column = end;
    }
  }
  for (int grey = 0; grey <= kGreys; ++grey) {
    const int value = 50 + 150 * grey / kGreys;
    if (const std::string& path = paths[static_cast<std::size_t>(grey)]; !path.empty()) {
      svg.add(fmt::format(R"(<path d="{}" fill="#{:02x}{:02x}{:02x}"/>)", path, value, value, value));
    }
  }
}

const FrameRequest& frame_of(const FramePlan& plan, const std::optional<std::int32_t>& number) {
  if (plan.frames.empty()) {
    throw Error(ErrorKind::usage, "`heat-frame`", "no frame is planned");
  }
  if (!number) {
    return plan.frames[plan.frames.size() / 2];
  }
  const auto found = std::find_if(plan.frames.begin(), plan.frames.end(),
                                  [&](const FrameRequest& request) { return request.frame == *number; });
  if (found == plan.frames.end()) {
    throw Error(ErrorKind::usage, "`heat-frame`", fmt::format("frame {} is not among the planned ones", *number),
                "name one of `frames`");
  }
  return *found;
}

}  // namespace

std::string scene_heat_svg(PathTracer& tracer, const FramePlan& plan, double frame_s, const GazeObjects& objects,
                           const SceneHeatSettings& settings) {
  if (!(settings.sigma_deg > 0) || settings.sigma_deg > 10) {
    throw Error(ErrorKind::usage, "`heat-sigma`", "must be above 0 and at most 10 degrees");
  }
  const FrameRequest& request = frame_of(plan, settings.frame);
  const std::string picture = picture_uri(settings.picture);
  HeatGrid grid;
  grid.columns = 360;
  grid.rows = std::max<std::size_t>(2, static_cast<std::size_t>(std::round(static_cast<double>(grid.columns) *
                                                                           request.height_px / request.width_px)));
  std::vector<Vec2d> places;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      places.push_back({(static_cast<double>(column) + 0.5) * request.width_px / static_cast<double>(grid.columns),
                        (static_cast<double>(row) + 0.5) * request.height_px / static_cast<double>(grid.rows)});
    }
  }
  const std::vector<RayHit> hits = tracer.at({request.t_video_ns, request.t_video_ns})
                                       .first_hits(request.camera, request.width_px, request.height_px, places);
  const std::vector<GazeSpot> spots = spots_of(objects, frame_s, settings.sigma_deg);
  grid.values.assign(places.size(), 0.0);
  double seconds = 0;
  if (!spots.empty()) {
    std::vector<double> reaches;
    for (const GazeSpot& spot : spots) {
      reaches.push_back(GazeSpot::kReach * spot.sd_m);
      seconds += spot.seconds;
    }
    std::nth_element(reaches.begin(), reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2), reaches.end());
    const SeenSurfaces surfaces(hits, std::max(reaches[reaches.size() / 2], 1e-9));
    for (const GazeSpot& spot : spots) {
      surfaces.add(spot, grid.values);
    }
    grid.highest = *std::max_element(grid.values.begin(), grid.values.end());
  }

  const double width = kWideWidth - 2 * kHeatMargin;
  const double height = width * static_cast<double>(grid.rows) / static_cast<double>(grid.columns);
  const Axis x_axis{0, 1, kHeatMargin, kHeatMargin + width};
  const Axis y_axis{0, 1, kHeatMargin, kHeatMargin + height};
  Drawing svg(kWideWidth, height + kHeatMargin + kBelowHeat,
              "Heat map: where on the scene the gaze of all frames fell");
  if (picture.empty()) {
    draw_surfaces(svg, hits, request.camera.pose.position_m, grid.columns, x_axis, y_axis);
  } else {
    svg.add(fmt::format(
        R"(<image x="{0}" y="{0}" width="{1:.1f}" height="{2:.1f}" preserveAspectRatio="none" href="{3}"/>)",
        kHeatMargin, width, height, picture));
    svg.add(
        fmt::format(R"(<rect x="{0}" y="{0}" width="{1:.1f}" height="{2:.1f}" fill="#000000" fill-opacity="0.35"/>)",
                    kHeatMargin, width, height));
  }
  if (grid.highest > 0) {
    draw_heat(svg, grid, x_axis, y_axis, "s of gaze per square metre");
  }
  svg.text(x_axis.end, y_axis.end + 25,
           fmt::format("{:.2g} s of gaze in {} frames, as frame {} sees it{}", seconds, objects.frames.size(),
                       request.frame, grid.highest > 0 ? "" : ": none of it"),
           "end");
  return svg.str();
}

}  // namespace gazetrace
