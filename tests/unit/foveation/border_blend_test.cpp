// SPDX-License-Identifier: Apache-2.0
// Regions that blend into each other over a rim, beside the paper's hard ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "foveation/sites.hpp"
#include "gazetrace/foveation.hpp"
#include "support/map_consistency.hpp"

namespace gazetrace {
namespace {

// Away from the rims the blended regions are the paper's: the same blocks with the same counts.
TEST(BorderBlend, EqualsHardRegionsAwayFromTheRims) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, 1920, 1080);
  const Vec3d gaze = view.direction(1000.2, 500.7);
  for (const RegionShape shape : {RegionShape::cone, RegionShape::disc}) {
    FoveationSettings settings;
    settings.shape = shape;
    const SamplingMap hard = make_sampling_map(settings, view, gaze);
    settings.border_blend_deg = 1;
    const SamplingMap soft = make_sampling_map(settings, view, gaze);
    expect_consistent(soft);
    const ImageGray hard_spp = samples_per_pixel(hard);
    const ImageGray soft_spp = samples_per_pixel(soft);
    const ImageGray density = *falloff_density(settings, view, gaze);
    int compared = 0;
    for (int y = 0; y < 1080; ++y) {
      for (int x = 0; x < 1920; ++x) {
        const double e = eccentricity_deg(view, gaze, x + 0.5, y + 0.5);
        const double margin = shape == RegionShape::disc ? 2.2 : 1.3;  // a disc's rim is not at an equal angle
        if (std::abs(e - 2.6) > margin && std::abs(e - 8.5) > margin) {
          ASSERT_EQ(hard_spp(x, y), soft_spp(x, y)) << x << "," << y;
          ++compared;
        }
      }
    }
    EXPECT_GT(compared, 1'000'000);
    if (shape == RegionShape::cone) {
      // In the middle of a rim the density is the geometric mean of both sides.
      for (int x = 1000; x < 1900; ++x) {
        const double e = eccentricity_deg(view, gaze, x + 0.5, 500.5);
        const auto smooth = [](double t) { return std::clamp(t, 0.0, 1.0); };
        const double t1 = smooth((e - 2.1) / 1.0);
        const double t2 = smooth((e - 8.0) / 1.0);
        const double s1 = t1 * t1 * (3 - 2 * t1);
        const double s2 = t2 * t2 * (3 - 2 * t2);
        const double spp = 32 * std::pow(4.0 / 32, s1) * std::pow(0.5 / 4, s2);
        EXPECT_NEAR(32 * static_cast<double>(density(x, 500)) / spp, 1, 1e-5);
      }
    }
  }
}

// Regions whose least rate is below the default floor and whose blocks are larger than the default limit stay what they
// are beside their rims; a floor or a limit that is asked for holds.
TEST(BorderBlend, RegionsKeepTheirOwnRatesAndBlocks) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, 960, 540);
  const Vec3d gaze = view.direction(480, 270);
  FoveationSettings settings;
  settings.region_blocks_px = {2, 32};  // 8 samples for 1024 pixels: a density of 1/4096
  settings.border_blend_deg = 1;
  const SamplingMap map = make_sampling_map(settings, view, gaze);
  expect_consistent(map);
  const ImageGray density = *falloff_density(settings, view, gaze);
  int compared = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    double nearest_deg = 180;
    for_each_pixel(map, map.sites[i], [&](int x, int y) {
      const double e = eccentricity_deg(view, gaze, x + 0.5, y + 0.5);
      nearest_deg = std::min(nearest_deg, e);
      if (e > 9.001) {
        ASSERT_FLOAT_EQ(density(x, y), 1.0F / 4096);
      }
    });
    if (nearest_deg > 13) {  // beyond the rim by more than a block's diagonal
      ++compared;
      ASSERT_EQ(map.regions[map.sites[i].region].block_px, 32);
      ASSERT_NEAR(map.expected(i), 8.0 * map.sites[i].pixels / 1024, 1e-5);
    }
  }
  EXPECT_GT(compared, 200);
  // With the default floor, 1/512 of 32 samples a pixel would be 32400 in all.
  settings.border_blend_deg = 0;
  const auto hard = static_cast<double>(make_sampling_map(settings, view, gaze).samples());
  EXPECT_LT(static_cast<double>(map.samples()), 1.3 * hard);

  settings.border_blend_deg = 1;
  settings.density_floor = 1.0 / 256;
  settings.max_block_px = 4;
  const SamplingMap asked = make_sampling_map(settings, view, gaze);
  EXPECT_EQ(asked.regions.back().block_px, 4);
  EXPECT_FLOAT_EQ((*falloff_density(settings, view, gaze))(3, 3), 1.0F / 256);
}

}  // namespace
}  // namespace gazetrace
