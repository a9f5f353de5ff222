// SPDX-License-Identifier: Apache-2.0
#include "foveation/site_images.hpp"

#include <algorithm>
#include <limits>

#include "core/parallel.hpp"

namespace gazetrace {

ImageGray samples_per_pixel(const SamplingMap& map) {
  return image_of_sites(map, [&](std::size_t i) {
    return static_cast<float>(static_cast<double>(map.sites[i].samples) / map.sites[i].pixels);
  });
}

ImageGray expected_spp_of(const SamplingMap& map) {
  return image_of_sites(map, [&](std::size_t i) { return static_cast<float>(map.expected(i) / map.sites[i].pixels); });
}

Image<std::uint32_t> sites_of_pixels(const SamplingMap& map, int threads) {
  Image<std::uint32_t> site_of_pixel(map.width_px, map.height_px);
  parallel_for(map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      for_each_pixel(map, map.sites[i], [&](int x, int y) { site_of_pixel(x, y) = static_cast<std::uint32_t>(i); });
    }
  });
  return site_of_pixel;
}

std::vector<BlockExtent> extents_of_blocks(const SamplingMap& map) {
  constexpr int kFar = std::numeric_limits<int>::max();
  std::vector<BlockExtent> extents(map.regions.size(), {kFar, kFar, 0, 0});
  for (const Site& site : map.sites) {
    BlockExtent& b = extents[site.region];
    b.x = std::min<int>(b.x, site.block_x);
    b.y = std::min<int>(b.y, site.block_y);
    b.x_end = std::max(b.x_end, site.block_x + 1);
    b.y_end = std::max(b.y_end, site.block_y + 1);
  }
  for (BlockExtent& b : extents) {
    b = b.x < b.x_end ? b : BlockExtent{};
  }
  return extents;
}

}  // namespace gazetrace
