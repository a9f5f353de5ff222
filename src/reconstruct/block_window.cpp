// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/block_window.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "reconstruct/block_bands.hpp"

namespace gazetrace {
namespace {

constexpr int kAround = 16;  // blocks; what is farther away from a region has no part in its residuals

}  // namespace

std::vector<BlockWindow> windows_of_regions(const SamplingMap& map) {
  std::vector<BlockWindow> windows;
  for (const BlockExtent& e : extents_of_blocks(map)) {
    const std::size_t r = windows.size();
    const int block = map.regions[r].block_px;
    if (e.x_end == 0) {
      windows.push_back({r, block, 0, 0, 0, 0});
      continue;
    }
    const int x = std::max(e.x - kAround, 0);
    const int y = std::max(e.y - kAround, 0);
    windows.push_back({r, block, x, y, std::min(e.x_end + kAround, (map.width_px + block - 1) / block) - x,
                       std::min(e.y_end + kAround, (map.height_px + block - 1) / block) - y});
  }
  return windows;
}

std::vector<std::uint32_t> sites_of_blocks(const FilterInput& input, const BlockWindow& window,
                                           const Image<std::uint32_t>& site_of_pixel) {
  const SamplingMap& map = input.map;
  std::vector<std::uint32_t> sites(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height));
  const int block = window.block_px;
  for_each_row(window.height, input.threads, [&](int y) {
    std::uint32_t* row = &sites[static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width)];
    const int py = std::min((window.y + y) * block + block / 2, map.height_px - 1);
    for (int x = 0; x < window.width; ++x) {
      row[x] = site_of_pixel(std::min((window.x + x) * block + block / 2, map.width_px - 1), py);
    }
  });
  if (block > 1) {
    parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
      const MapTile& tile = map.tiles[t];
      for (std::uint32_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
        const Site& site = map.sites[i];
        if (site.region == window.region) {
          sites[static_cast<std::size_t>(site.block_y - window.y) * static_cast<std::size_t>(window.width) +
                static_cast<std::size_t>(site.block_x - window.x)] = i;
        }
      }
    });
  }
  return sites;
}

}  // namespace gazetrace
