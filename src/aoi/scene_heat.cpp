// SPDX-License-Identifier: Apache-2.0
// The heat map on the surfaces of a scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aoi/seen_surfaces.hpp"
#include "gazetrace/gaze_objects.hpp"

namespace gazetrace {
namespace {

constexpr int kColumns = 480;
constexpr std::uint8_t kEnvironmentGrey = 200, kOutlineGrey = 62;

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
std::uint8_t grey_at(const std::vector<RayHit>& hits, std::size_t columns, std::size_t row, std::size_t column,
                     const Vec3d& eye) {
  const std::size_t rows = hits.size() / columns;
  const RayHit& hit = hits[row * columns + column];
  if (hit.object == 0) {
    return kEnvironmentGrey;
  }
  const RayHit& beside = hits[row * columns + (column + 1 < columns ? column + 1 : column - 1)];
  const RayHit& below = hits[(row + 1 < rows ? row + 1 : row - 1) * columns + column];
  if (beside.object != hit.object || below.object != hit.object) {
    return kOutlineGrey;
  }
  const Vec3d normal = cross(beside.position_m - hit.position_m, below.position_m - hit.position_m);
  const Vec3d towards = eye - hit.position_m;
  const double cosine = std::abs(dot(normal, towards)) / std::max(length(normal) * length(towards), 1e-300);
  return static_cast<std::uint8_t>(std::lround(75 + 115 * std::min(cosine, 1.0)));
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

SceneHeat scene_heat(PathTracer& tracer, const FramePlan& plan, double frame_s, const GazeObjects& objects,
                     const SceneHeatSettings& settings) {
  if (!(settings.sigma_deg > 0) || settings.sigma_deg > 10) {
    throw Error(ErrorKind::usage, "`heat-sigma`", "must be above 0 and at most 10 degrees");
  }
  const FrameRequest& request = frame_of(plan, settings.frame);
  SceneHeat heat;
  heat.frame = request.frame;
  heat.width_px = kColumns;
  heat.height_px = std::max(
      2, static_cast<int>(std::lround(static_cast<double>(heat.width_px) * request.height_px / request.width_px)));
  std::vector<Vec2d> places;
  for (int y = 0; y < heat.height_px; ++y) {
    for (int x = 0; x < heat.width_px; ++x) {
      places.push_back({(x + 0.5) * request.width_px / heat.width_px, (y + 0.5) * request.height_px / heat.height_px});
    }
  }
  const std::vector<RayHit> hits = tracer.at({request.t_video_ns, request.t_video_ns})
                                       .first_hits(request.camera, request.width_px, request.height_px, places);
  const auto columns = static_cast<std::size_t>(heat.width_px);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    heat.greys.push_back(grey_at(hits, columns, i / columns, i % columns, request.camera.pose.position_m));
  }
  heat.values.assign(hits.size(), 0.0);
  const std::vector<GazeSpot> spots = spots_of(objects, frame_s, settings.sigma_deg);
  if (spots.empty()) {
    return heat;
  }
  std::vector<double> reaches;
  for (const GazeSpot& spot : spots) {
    reaches.push_back(GazeSpot::kReach * spot.sd_m);
    heat.seconds += spot.seconds;
  }
  std::nth_element(reaches.begin(), reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2), reaches.end());
  const SeenSurfaces surfaces(hits, std::max(reaches[reaches.size() / 2], 1e-9));
  for (const GazeSpot& spot : spots) {
    surfaces.add(spot, heat.values);
  }
  heat.highest = *std::max_element(heat.values.begin(), heat.values.end());
  return heat;
}

}  // namespace gazetrace
