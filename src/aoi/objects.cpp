// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "aoi/object_names.hpp"
#include "gazetrace/gaze_objects.hpp"

namespace gazetrace {
namespace {

void check_settings(const GazeObjectsSettings& settings) {
  const GazeUncertainty& u = settings.uncertainty;
  if (!(u.accuracy_deg >= 0) || !(u.precision_deg >= 0) || !(u.accuracy_deg < 45) || !(u.precision_deg < 45)) {
    throw Error(ErrorKind::usage, "", "accuracy and precision of gaze are angles from 0 to 45 degrees");
  }
  if (settings.rays < 16 || settings.rays > 65536) {
    throw Error(ErrorKind::usage, "`rays`", fmt::format("{} rays in a cone", settings.rays), "ask for 16 to 65536");
  }
  if (settings.nearest < 0 || settings.nearest > 100 || settings.grid_rays < 0 || settings.grid_rays > 100'000'000) {
    throw Error(ErrorKind::usage, "", "the number of nearest objects, or of the rays that seek them, is out of range");
  }
}

// The centres of equal cells over the frame, about `count` of them.
std::vector<Vec2d> grid_over(const PlanarView& view, int count, double& step_px) {
  std::vector<Vec2d> places;
  step_px = std::max(1.0, std::sqrt(static_cast<double>(view.width_px) * view.height_px / std::max(count, 1)));
  const int columns = std::max(1, static_cast<int>(std::round(view.width_px / step_px)));
  const int rows = std::max(1, static_cast<int>(std::round(view.height_px / step_px)));
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      places.push_back({(x + 0.5) * view.width_px / columns, (y + 0.5) * view.height_px / rows});
    }
  }
  return places;
}

class FrameSearch {
 public:
  FrameSearch(const PosedScene& posed, const FrameRequest& request, ObjectNames& names)
      : posed_(posed), request_(request), names_(names), gaze_(*request.gaze_direction_true) {}

  void find_shares(const GazeObjectsSettings& settings, FrameObjects& found) {
    const std::vector<Vec3d> cone = gaze_cone(gaze_, settings.uncertainty, settings.rays);
    std::vector<Vec2d> places;
    for (const Vec3d& direction : cone) {
      const Vec2d at = request_.view.pixel(direction);
      const bool is_inside = at.x >= 0 && at.y >= 0 && at.x <= request_.width_px && at.y <= request_.height_px;
      if (is_inside) {  // false for NaN
        places.push_back(at);
      } else {
        found.beside_share += 1.0 / settings.rays;
      }
    }
    // The rays come from the middle of the cone outwards, so that an object's first one is the nearest.
    std::map<std::size_t, ObjectShare> shares;
    std::vector<RayHit> hits = hits_at(places);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const std::size_t object = names_.of(hits[i]);
      const auto [share, is_first] =
          shares.try_emplace(object, ObjectShare{object, 0, hits[i].distance_m, hits[i].position_m});
      share->second.share += 1.0 / settings.rays;
      note_distance(object, places[i]);
    }
    for (const auto& [object, share] : shares) {
      found.shares.push_back(share);
    }
    std::stable_sort(found.shares.begin(), found.shares.end(),
                     [](const ObjectShare& a, const ObjectShare& b) { return a.share > b.share; });
    if (settings.keep_hits) {
      found.hits = std::move(hits);
    }
  }

  void find_nearest(const std::vector<Vec2d>& grid, int count, FrameObjects& found) {
    const std::vector<RayHit> hits = hits_at(grid);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      note_distance(names_.of(hits[i]), grid[i]);
    }
    for (const auto& [object, eccentricity] : nearest_deg_) {
      if (object != 0) {
        found.nearest.push_back({object, eccentricity});
      }
    }
    std::stable_sort(found.nearest.begin(), found.nearest.end(),
                     [](const NearObject& a, const NearObject& b) { return a.eccentricity_deg < b.eccentricity_deg; });
    // Of a node that has several materials, the nearest one.
    std::vector<NearObject> nodes;
    for (const NearObject& near : found.nearest) {
      const auto is_same = [&](const NearObject& other) {
        return names_.objects()[other.object].node == names_.objects()[near.object].node;
      };
      if (nodes.size() < static_cast<std::size_t>(count) && std::none_of(nodes.begin(), nodes.end(), is_same)) {
        nodes.push_back(near);
      }
    }
    found.nearest = std::move(nodes);
  }

 private:
  [[nodiscard]] std::vector<RayHit> hits_at(const std::vector<Vec2d>& places) const {
    return posed_.first_hits(request_.camera, request_.width_px, request_.height_px, places);
  }
  void note_distance(std::size_t object, const Vec2d& place) {
    const double deg = eccentricity_deg(request_.view, gaze_, place.x, place.y);
    const auto [known, is_new] = nearest_deg_.try_emplace(object, deg);
    known->second = std::min(known->second, deg);
  }

  const PosedScene& posed_;
  const FrameRequest& request_;
  ObjectNames& names_;
  Vec3d gaze_;
  std::map<std::size_t, double> nearest_deg_;
};

}  // namespace

GazeObjects gaze_objects(PathTracer& tracer, const Scene& scene, const FramePlan& plan,
                         const GazeObjectsSettings& settings) {
  check_settings(settings);
  GazeObjects result;
  result.settings = settings;
  ObjectNames names(scene);
  std::vector<Vec2d> grid;
  if (!plan.frames.empty() && settings.grid_rays > 0 && settings.nearest > 0) {
    const PlanarView& view = plan.frames.front().view;
    double step_px = 0;
    grid = grid_over(view, settings.grid_rays, step_px);
    const double x = 0.5 * view.width_px;
    const double y = 0.5 * view.height_px;
    result.grid_deg = eccentricity_deg(view, view.direction(x, y), x + step_px, y);
  }
  for (const FrameRequest& request : plan.frames) {
    FrameObjects found;
    found.frame = request.frame;
    found.t_video_ns = request.t_video_ns;
    found.t_log_ns = request.gaze_true.t_log_ns;
    found.state = request.gaze_true.no_gaze ? GazeState::none : request.gaze_true.state;
    found.movement = request.gaze_true.movement;
    const bool has_gaze = found.state == GazeState::measured || found.state == GazeState::held;
    if (has_gaze && request.gaze_direction_true) {
      const PosedScene posed = tracer.at({request.t_video_ns, request.t_video_ns});
      FrameSearch search(posed, request, names);
      search.find_shares(settings, found);
      if (!grid.empty()) {
        search.find_nearest(grid, settings.nearest, found);
      }
    }
    result.frames.push_back(std::move(found));
  }
  result.objects = names.objects();
  return result;
}

}  // namespace gazetrace
