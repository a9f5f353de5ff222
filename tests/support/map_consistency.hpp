// SPDX-License-Identifier: Apache-2.0
// Properties that every sampling map must have.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "foveation/sites.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {

// Checks that every pixel belongs to one site of its own region, and that regions and tiles are the sums of their
// sites.
inline void expect_consistent(const SamplingMap& map) {
  std::vector<int> owners(map.region.pixels.size(), 0);
  std::vector<MapRegion> totals(map.regions.size());
  std::vector<PixelIndex> pixels;
  for (const Site& site : map.sites) {
    pixels_of_site(map, site, pixels);
    ASSERT_EQ(pixels.size(), site.pixels);
    ASSERT_GT(site.pixels, 0);
    for (const PixelIndex& p : pixels) {
      ASSERT_EQ(map.region(p.x, p.y), site.region);
      ++owners[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(map.width_px) + p.x];
    }
    totals[site.region].pixels += site.pixels;
    totals[site.region].samples += site.samples;
    totals[site.region].sites += 1;
  }
  EXPECT_TRUE(std::all_of(owners.begin(), owners.end(), [](int n) { return n == 1; }));
  for (std::size_t r = 0; r < totals.size(); ++r) {
    EXPECT_EQ(totals[r].pixels, map.regions[r].pixels);
    EXPECT_EQ(totals[r].samples, map.regions[r].samples);
    EXPECT_EQ(totals[r].sites, map.regions[r].sites);
  }
  std::uint32_t next = 0;
  for (const MapTile& tile : map.tiles) {
    EXPECT_EQ(tile.first_site, next);
    next += tile.site_count;
    std::uint64_t samples = 0;
    for (std::uint32_t i = tile.first_site; i < next; ++i) {
      samples += map.sites[i].samples;
    }
    EXPECT_EQ(samples, tile.samples);
  }
  EXPECT_EQ(next, map.sites.size());
}

}  // namespace gazetrace
