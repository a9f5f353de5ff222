// SPDX-License-Identifier: Apache-2.0
// The sums of a heat map on surfaces, against a walk over all pairs of a spot and a place.
#include <gtest/gtest.h>

#include <cmath>

#include "aoi/seen_surfaces.hpp"

namespace gazetrace::seen_surfaces_test {
namespace {

// A wall of 40 x 40 places in the plane z, `step_m` apart and centered.
void add_wall(std::vector<RayHit>& hits, std::uint32_t object, double z, double step_m) {
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      RayHit hit;
      hit.object = object;
      hit.position_m = {(column - 19.5) * step_m, (row - 19.5) * step_m, z};
      hits.push_back(hit);
    }
  }
}

// In the order of the spots, as each value is summed.
std::vector<double> of_all_pairs(const std::vector<RayHit>& hits, const std::vector<GazeSpot>& spots) {
  std::vector<double> values(hits.size(), 0.0);
  for (const GazeSpot& spot : spots) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const Vec3d apart = hits[i].position_m - spot.at;
      const double squares = dot(apart, apart) / (spot.sd_m * spot.sd_m);
      if (hits[i].object == spot.object && squares < 9) {
        values[i] += spot.seconds / (2 * kPi * spot.sd_m * spot.sd_m) * std::exp(-0.5 * squares);
      }
    }
  }
  return values;
}

class SeenSurfacesOf : public testing::Test {
 protected:
  SeenSurfacesOf() {
    add_wall(hits_, 1, -1, 0.005);
    add_wall(hits_, 2, -500, 2.5);
    hits_.emplace_back();  // the environment
  }
  // Half of the spots are 1 m away, and half of them `far_m`; each spreads by 0.35 degrees.
  [[nodiscard]] static std::vector<GazeSpot> spots(double far_m) {
    std::vector<GazeSpot> spots;
    for (int i = 0; i < 60; ++i) {
      const double distance_m = i % 2 == 0 ? 1 : far_m;
      spots.push_back({{0.07 * std::sin(i * 2.3) * distance_m, 0.07 * std::cos(i * 3.7) * distance_m, -distance_m},
                       0.0061 * distance_m,
                       0.001 * (i + 1),
                       i % 2 == 0 ? 1U : 2U});
    }
    return spots;
  }
  void expect_sums(const std::vector<GazeSpot>& spots, double cell_m) {
    const SeenSurfaces surfaces(hits_, cell_m);
    std::vector<double> values(hits_.size(), 0.0);
    for (const GazeSpot& spot : spots) {
      surfaces.add(spot, values);
    }
    EXPECT_EQ(values, of_all_pairs(hits_, spots));
    EXPECT_GT(values[20 * 40 + 20] + values[10 * 40 + 10], 0);
  }

  std::vector<RayHit> hits_;
};

TEST_F(SeenSurfacesOf, SpotsNearAndFarAreSumsOverAllPairs) {
  // The reach of near spots as the size of cells: boxes of three cells to a side near by, of a thousand far away.
  expect_sums(spots(500), 0.018);
  // All cells in one box, and one cell for all.
  expect_sums(spots(500), 10);
  expect_sums(spots(500), 1e4);
}

TEST_F(SeenSurfacesOf, PlacesBeyondEveryCellAreFound) {
  RayHit hit;
  hit.object = 2;
  hit.position_m = {0, 1, -1e11};
  hits_.push_back(hit);
  std::vector<GazeSpot> all = spots(500);
  all.push_back({{0, 0, -1e11}, 10, 1, 2});
  expect_sums(all, 1e-9);
}

}  // namespace
}  // namespace gazetrace::seen_surfaces_test
