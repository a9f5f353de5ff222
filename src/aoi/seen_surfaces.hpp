// SPDX-License-Identifier: Apache-2.0
// Where gaze that fell on a scene is seen again from one of its frames.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "gazetrace/trace.hpp"

namespace gazetrace {

// A hit of a cone's ray, and how it spreads.
struct GazeSpot {
  // Beyond so many standard deviations it leaves nothing.
  static constexpr double kReach = 3;

  Vec3d at;
  double sd_m = 0;
  double seconds = 0;
  std::uint32_t object = 0;
};

// What the cells of a grid over the frame see, found again by where it is in the world. `hits` must outlive it.
class SeenSurfaces {
 public:
  SeenSurfaces(const std::vector<RayHit>& hits, double cell_m);

  // Adds what a spot leaves at each place of its body that is seen: seconds per square metre, one value for each hit.
  void add(const GazeSpot& spot, std::vector<double>& values) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };

  [[nodiscard]] Cell cell_of(const Vec3d& at) const;
  void add_to(const std::vector<std::uint32_t>& hits, const GazeSpot& spot, std::vector<double>& values) const;

  const std::vector<RayHit>& hits_;
  double cell_m_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

}  // namespace gazetrace
