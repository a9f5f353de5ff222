// SPDX-License-Identifier: Apache-2.0
// Random frames, gazes, angles and blocks against a pixel-by-pixel definition, and what holds for every map.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace::sampling_map_property_test {
namespace {

struct Case {
  FoveationSettings settings;
  PlanarView view;
  Vec3d gaze;
  std::string text;
};

// The definition, written down plainly.
int region_by_definition(const Case& c, int x, int y) {
  const RegionSampling& regions = std::get<RegionSampling>(c.settings.sampling);
  if (regions.shape == RegionShape::cone) {
    const Vec3d v{c.view.left + (x + 0.5) * c.view.step_x, c.view.top - (y + 0.5) * c.view.step_y, -1};
    const Vec3d n = cross(c.gaze, v);
    const double e = std::atan2(std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z), dot(c.gaze, v)) * 180 / kPi;
    return e <= regions.eccentricities_deg[0] ? 0 : e <= regions.eccentricities_deg[1] ? 1 : 2;
  }
  if (c.gaze.z >= 0) {
    return 2;
  }
  const double gaze_x = (c.gaze.x / -c.gaze.z - c.view.left) / c.view.step_x;
  const double gaze_y = (c.view.top - c.gaze.y / -c.gaze.z) / c.view.step_y;
  const double square = (x + 0.5 - gaze_x) * (x + 0.5 - gaze_x) + (y + 0.5 - gaze_y) * (y + 0.5 - gaze_y);
  for (int r = 0; r < 2; ++r) {
    const double e = regions.eccentricities_deg[static_cast<std::size_t>(r)] * kPi / 180;
    const double radius = (regions.shape == RegionShape::disc ? std::tan(e) : 2 * std::tan(e / 2)) / c.view.step_x;
    if (square <= radius * radius) {
      return r;
    }
  }
  return 2;
}

void expect_consistent_blocks(const SamplingMap& map) {
  // Every pixel belongs to exactly one site, and the site's region is the pixel's.
  Image<int> owners(map.width_px, map.height_px, 0);
  std::vector<MapRegion> totals(map.regions.size());
  std::vector<PixelIndex> pixels;
  for (const Site& site : map.sites) {
    ASSERT_LT(site.region, map.regions.size());
    pixels_of_site(map, site, pixels);
    ASSERT_EQ(pixels.size(), site.pixels);
    ASSERT_GT(site.pixels, 0);
    ASSERT_GT(site.samples, 0U);
    const int block = map.regions[site.region].block_px;
    for (const PixelIndex& p : pixels) {
      ASSERT_EQ(map.region(p.x, p.y), site.region);
      ASSERT_EQ(p.x / block, site.block_x);
      ASSERT_EQ(p.y / block, site.block_y);
      ++owners(p.x, p.y);
    }
    totals[site.region].pixels += site.pixels;
    totals[site.region].samples += site.samples;
    totals[site.region].sites += 1;
  }
  EXPECT_TRUE(std::all_of(owners.pixels.begin(), owners.pixels.end(), [](int n) { return n == 1; }));
  std::uint64_t samples = 0;
  for (std::size_t r = 0; r < totals.size(); ++r) {
    EXPECT_EQ(totals[r].pixels, map.regions[r].pixels);
    EXPECT_EQ(totals[r].samples, map.regions[r].samples);
    EXPECT_EQ(totals[r].sites, map.regions[r].sites);
    samples += totals[r].samples;
  }
  EXPECT_EQ(samples, map.samples());

  // The tiles cut both the frame and the list of sites, and hold their sites' block origins.
  Image<int> tiled(map.width_px, map.height_px, 0);
  std::uint32_t next = 0;
  for (const MapTile& tile : map.tiles) {
    EXPECT_EQ(tile.first_site, next);
    next += tile.site_count;
    std::uint64_t tile_samples = 0;
    for (std::uint32_t i = tile.first_site; i < next; ++i) {
      const Site& site = map.sites[i];
      const int block = map.regions[site.region].block_px;
      const int x = site.block_x * block;
      const int y = site.block_y * block;
      EXPECT_TRUE(x >= tile.x_px && x < tile.x_px + tile.width_px && y >= tile.y_px && y < tile.y_px + tile.height_px);
      tile_samples += site.samples;
    }
    EXPECT_EQ(tile_samples, tile.samples);
    for (int y = tile.y_px; y < tile.y_px + tile.height_px; ++y) {
      for (int x = tile.x_px; x < tile.x_px + tile.width_px; ++x) {
        ++tiled(x, y);
      }
    }
  }
  EXPECT_EQ(next, map.sites.size());
  EXPECT_TRUE(std::all_of(tiled.pixels.begin(), tiled.pixels.end(), [](int n) { return n == 1; }));
}

class RandomCases {
 public:
  Case next() {
    Case c;
    const int width = pick(1, 150);
    const int height = pick(1, 110);
    const double yfov_deg = std::pow(10.0, real(-1, 2.25));
    c.view = view_of_perspective(yfov_deg * kRadPerDeg, width, height);
    if (pick(0, 1) == 1) {  // off-axis, as an eye that is not before the middle of its display
      c.view.left += real(-1, 1) * width * c.view.step_x;
      c.view.top += real(-1, 1) * height * c.view.step_y;
    }
    switch (pick(0, 4)) {
      case 0:  // anywhere around the eye
        c.gaze = {real(-1, 1), real(-1, 1), real(-1, 1)};
        break;
      case 1:  // exactly on a pixel's corner or centre
        c.gaze = c.view.direction(0.5 * pick(0, 2 * width), 0.5 * pick(0, 2 * height));
        break;
      case 2:  // off the frame by up to ten times its size
        c.gaze = c.view.direction(real(-10, 11) * width, real(-10, 11) * height);
        break;
      default:
        c.gaze = c.view.direction(real(0, 1) * width, real(0, 1) * height);
    }
    RegionSampling& regions = std::get<RegionSampling>(c.settings.sampling);
    const RegionShape disc = pick(0, 1) == 0 ? RegionShape::disc : RegionShape::disc_by_radius;
    regions.shape = pick(0, 2) == 0 ? disc : RegionShape::cone;
    regions.unit = pick(0, 2) == 0 ? SampleUnit::per_pixel : SampleUnit::per_block;
    const double wide = pick(0, 2) == 0 ? 179.9 : 1.5 * yfov_deg;
    const double most = regions.shape == RegionShape::disc ? 89.95 : 179.9;
    const double a = std::min(real(0, 1) * wide, most);
    const double b = std::min(real(0, 1) * wide, most);
    regions.eccentricities_deg = {std::min(a, b), std::max(a, b)};
    const int blocks = pick(0, 2) == 0 ? 64 : 9;
    regions.blocks_px = {pick(1, blocks), pick(1, blocks)};
    c.text = std::to_string(width) + "x" + std::to_string(height) + " field " + std::to_string(yfov_deg) + " blocks " +
             std::to_string(regions.blocks_px[0]) + "," + std::to_string(regions.blocks_px[1]);
    return c;
  }

 private:
  int pick(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::mt19937 random_{20261121};
};

TEST(SamplingMapProperty, EqualsTheDefinitionAtEveryPixel) {
  RandomCases cases;
  std::array<int, 3> seen{};
  for (int i = 0; i < 400; ++i) {
    const Case c = cases.next();
    SCOPED_TRACE("case " + std::to_string(i) + ": " + c.text);
    const SamplingMap map = make_sampling_map(c.settings, c.view, c.gaze);
    int wrong = 0;
    for (int y = 0; y < map.height_px; ++y) {
      for (int x = 0; x < map.width_px; ++x) {
        const int expected = region_by_definition(c, x, y);
        ++seen.at(static_cast<std::size_t>(expected));
        wrong += map.region(x, y) == expected ? 0 : 1;
      }
    }
    EXPECT_EQ(wrong, 0);
    expect_consistent_blocks(map);
    if (HasFailure()) {
      return;
    }
  }
  for (const int pixels : seen) {
    EXPECT_GT(pixels, 100000);  // the cases exercise all three regions
  }
}

TEST(SamplingMapProperty, MirrorSymmetricAboutTheGaze) {
  for (const RegionShape shape : {RegionShape::cone, RegionShape::disc}) {
    FoveationSettings settings;
    std::get<RegionSampling>(settings.sampling).shape = shape;
    std::get<RegionSampling>(settings.sampling).eccentricities_deg = {10, 22.5};
    const PlanarView view = view_of_perspective(1.2, 121, 80);
    const SamplingMap map = make_sampling_map(settings, view, view.direction(60.5, 40));
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 121; ++x) {
        EXPECT_EQ(map.region(x, y), map.region(120 - x, y));
        EXPECT_EQ(map.region(x, y), map.region(x, 79 - y));
      }
    }
  }
}

TEST(SamplingMapProperty, DensityNeverRisesWithEccentricity) {
  FoveationSettings settings;
  std::get<RegionSampling>(settings.sampling).eccentricities_deg = {7.5, 20};
  const PlanarView view = view_of_perspective(1.4, 160, 96);
  const Vec3d gaze = view.direction(45, 30);
  const SamplingMap map = make_sampling_map(settings, view, gaze);
  const ImageGray eccentricity = eccentricity_image(view, gaze);
  std::vector<std::pair<float, int>> order;
  for (std::size_t i = 0; i < eccentricity.pixels.size(); ++i) {
    order.emplace_back(eccentricity.pixels[i], map.region.pixels[i]);
  }
  std::sort(order.begin(), order.end());
  EXPECT_TRUE(
      std::is_sorted(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second < b.second; }));
}

TEST(SamplingMapProperty, ExtremeFrames) {
  FoveationSettings settings;
  const PlanarView dot = view_of_perspective(1.0, 1, 1);
  std::get<RegionSampling>(settings.sampling).blocks_px = {64, 64};
  expect_consistent_blocks(make_sampling_map(settings, dot, dot.direction(0.5, 0.5)));
  expect_consistent_blocks(make_sampling_map(settings, dot, dot.direction(1e6, 0)));
  for (const int block : {1, 3, 7, 64}) {
    std::get<RegionSampling>(settings.sampling).blocks_px = {block, 64};
    Case c;
    c.settings = settings;
    c.view = view_of_perspective(0.1 * kRadPerDeg, 16384, 16);
    c.gaze = c.view.direction(7000.3, 9);
    std::get<RegionSampling>(c.settings.sampling).eccentricities_deg = {0.5, 25};
    const SamplingMap map = make_sampling_map(c.settings, c.view, c.gaze);
    expect_consistent_blocks(map);
    for (int y = 0; y < map.height_px; ++y) {
      for (int x = 0; x < map.width_px; ++x) {
        ASSERT_EQ(map.region(x, y), region_by_definition(c, x, y));
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::sampling_map_property_test
