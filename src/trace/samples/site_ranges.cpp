// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/site_ranges.hpp"

#include <algorithm>
#include <cstddef>

namespace gazetrace {
namespace {

SiteRange site_of_pixel(const SamplingMap& map, const PixelIndex& pixel) {
  if (pixel.x >= map.width_px || pixel.y >= map.height_px) {
    return {};
  }
  const std::uint8_t region = map.region(pixel.x, pixel.y);
  const int block = map.regions[region].block_px;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const Site& site = map.sites[i];
    if (site.region == region && site.block_x == pixel.x / block && site.block_y == pixel.y / block) {
      return {static_cast<std::uint32_t>(i), 1};
    }
  }
  return {};
}

}  // namespace

std::vector<SiteRange> site_ranges(const SamplingMap& map, const std::optional<PixelIndex>& only_pixel) {
  if (only_pixel) {
    return {site_of_pixel(map, *only_pixel)};
  }
  constexpr std::uint32_t kLeastRanges = 16;
  constexpr std::uint32_t kLeastSites = 64;
  const auto tiles = static_cast<std::uint32_t>(map.tiles.size());
  const std::uint32_t parts = tiles == 0 ? 1 : (kLeastRanges + tiles - 1) / tiles;
  std::vector<SiteRange> ranges;
  for (const MapTile& tile : map.tiles) {
    const std::uint32_t step = std::max(kLeastSites, (tile.site_count + parts - 1) / parts);
    for (std::uint32_t begin = 0; begin < tile.site_count; begin += step) {
      ranges.push_back({tile.first_site + begin, std::min(step, tile.site_count - begin)});
    }
  }
  return ranges;
}

}  // namespace gazetrace
