// SPDX-License-Identifier: Apache-2.0
// The heat map on the surfaces of a scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <unordered_map>

#include "gazetrace/gaze_objects.hpp"
#include "study/report/heat.hpp"

namespace gazetrace {
namespace {

constexpr double kReach = 3;  // standard deviations
constexpr int kGreys = 12;

// A hit of a cone's ray, and how it spreads.
struct Spot {
  Vec3d at;
  double sd_m = 0;
  double seconds = 0;
  std::uint32_t object = 0;
};

std::vector<Spot> spots_of(const GazeObjects& objects, double frame_s, double sigma_deg) {
  std::vector<Spot> spots;
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

// What the cells of a grid over the frame see, found again by where it is in the world.
class SeenSurfaces {
 public:
  SeenSurfaces(const std::vector<RayHit>& hits, double cell_m) : hits_(hits), cell_m_(cell_m) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (hits[i].object != 0) {
        cells_[key(cell_of(hits[i].position_m))].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }

  // Adds what a spot leaves at each place of its body that is seen.
  void add(const Spot& spot, std::vector<double>& values) const {
    const double reach_m = kReach * spot.sd_m;
    const double peak = spot.seconds / (2 * kPi * spot.sd_m * spot.sd_m);
    const std::array<std::int64_t, 3> low = cell_of(spot.at - Vec3d{reach_m, reach_m, reach_m});
    const std::array<std::int64_t, 3> high = cell_of(spot.at + Vec3d{reach_m, reach_m, reach_m});
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto cell = cells_.find(key({x, y, z}));
          if (cell == cells_.end()) {
            continue;
          }
          for (const std::uint32_t i : cell->second) {
            const Vec3d apart = hits_[i].position_m - spot.at;
            const double squares = dot(apart, apart) / (spot.sd_m * spot.sd_m);
            if (squares < kReach * kReach && hits_[i].object == spot.object) {
              values[i] += peak * std::exp(-0.5 * squares);
            }
          }
        }
      }
    }
  }

 private:
  [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Vec3d& at) const {
    return {static_cast<std::int64_t>(std::floor(at.x / cell_m_)),
            static_cast<std::int64_t>(std::floor(at.y / cell_m_)),
            static_cast<std::int64_t>(std::floor(at.z / cell_m_))};
  }
  // Cells far apart may share a key: what is in them is looked at all the same, and is too far away.
  static std::uint64_t key(const std::array<std::int64_t, 3>& cell) {
    constexpr std::uint64_t kMask = (1U << 21U) - 1;
    return (static_cast<std::uint64_t>(cell[0]) & kMask) << 42U | (static_cast<std::uint64_t>(cell[1]) & kMask) << 21U |
           (static_cast<std::uint64_t>(cell[2]) & kMask);
  }

  const std::vector<RayHit>& hits_;
  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

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
  const std::vector<Spot> spots = spots_of(objects, frame_s, settings.sigma_deg);
  grid.values.assign(places.size(), 0.0);
  double seconds = 0;
  if (!spots.empty()) {
    std::vector<double> reaches;
    for (const Spot& spot : spots) {
      reaches.push_back(kReach * spot.sd_m);
      seconds += spot.seconds;
    }
    std::nth_element(reaches.begin(), reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2), reaches.end());
    const SeenSurfaces surfaces(hits, std::max(reaches[reaches.size() / 2], 1e-9));
    for (const Spot& spot : spots) {
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
