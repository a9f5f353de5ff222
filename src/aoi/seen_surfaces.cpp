// SPDX-License-Identifier: Apache-2.0
#include "aoi/seen_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace gazetrace {

SeenSurfaces::SeenSurfaces(const std::vector<RayHit>& hits, double cell_m) : hits_(hits), cell_m_(cell_m) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].object != 0) {
      cells_[cell_of(hits[i].position_m)].push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void SeenSurfaces::add(const GazeSpot& spot, std::vector<double>& values) const {
  const double reach_m = GazeSpot::kReach * spot.sd_m;
  const Cell low = cell_of(spot.at - Vec3d{reach_m, reach_m, reach_m});
  const Cell high = cell_of(spot.at + Vec3d{reach_m, reach_m, reach_m});
  double box = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box *= static_cast<double>(high[axis] - low[axis] + 1);
  }
  // Rays that end far away reach over far more cells than hold anything. Either walk gives the same sums bit by bit,
  // since a spot adds to each value at most once.
  if (box > static_cast<double>(cells_.size())) {
    for (const auto& [cell, hits] : cells_) {
      const bool is_near = cell[0] >= low[0] && cell[0] <= high[0] && cell[1] >= low[1] && cell[1] <= high[1] &&
                           cell[2] >= low[2] && cell[2] <= high[2];
      if (is_near) {
        add_to(hits, spot, values);
      }
    }
    return;
  }
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        if (const auto cell = cells_.find({x, y, z}); cell != cells_.end()) {
          add_to(cell->second, spot, values);
        }
      }
    }
  }
}

void SeenSurfaces::add_to(const std::vector<std::uint32_t>& hits, const GazeSpot& spot,
                          std::vector<double>& values) const {
  const double peak = spot.seconds / (2 * kPi * spot.sd_m * spot.sd_m);
  for (const std::uint32_t i : hits) {
    const Vec3d apart = hits_[i].position_m - spot.at;
    const double squares = dot(apart, apart) / (spot.sd_m * spot.sd_m);
    if (squares < GazeSpot::kReach * GazeSpot::kReach && hits_[i].object == spot.object) {
      values[i] += peak * std::exp(-0.5 * squares);
    }
  }
}

std::size_t SeenSurfaces::CellHash::operator()(const Cell& cell) const {
  constexpr std::uint64_t kMask = (1U << 21U) - 1;
  return (static_cast<std::uint64_t>(cell[0]) & kMask) << 42U | (static_cast<std::uint64_t>(cell[1]) & kMask) << 21U |
         (static_cast<std::uint64_t>(cell[2]) & kMask);
}

SeenSurfaces::Cell SeenSurfaces::cell_of(const Vec3d& at) const {
  // What is farther away than any scene shares the outermost cells.
  constexpr double kFarthest = 1e15;
  const auto index = [&](double x) {
    return static_cast<std::int64_t>(std::clamp(std::floor(x / cell_m_), -kFarthest, kFarthest));
  };
  return {index(at.x), index(at.y), index(at.z)};
}

}  // namespace gazetrace
