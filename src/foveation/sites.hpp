// SPDX-License-Identifier: Apache-2.0
// Sites and their blocks: how a layout becomes a map, and how to visit a site's pixels.
#pragma once

#include <algorithm>

#include "foveation/model.hpp"

namespace gazetrace {

// The pixels of a block inside the frame: [x, x_end) x [y, y_end).
struct BlockRect {
  int x, y, x_end, y_end;
};
inline BlockRect block_rect(const SamplingMap& map, const Site& site) {
  const int block = map.regions[site.region].block_px;
  const int x = site.block_x * block;
  const int y = site.block_y * block;
  return {x, y, std::min(x + block, map.width_px), std::min(y + block, map.height_px)};
}

// Calls visit(x, y) for every pixel of a site, row by row.
template <class Visit>
void for_each_pixel(const SamplingMap& map, const Site& site, const Visit& visit) {
  const BlockRect rect = block_rect(map, site);
  const bool full = site.pixels == (rect.x_end - rect.x) * (rect.y_end - rect.y);
  for (int y = rect.y; y < rect.y_end; ++y) {
    for (int x = rect.x; x < rect.x_end; ++x) {
      if (full || map.region(x, y) == site.region) {
        visit(x, y);
      }
    }
  }
}

// Divides a layout into sites, tile by tile, and adds up the totals.
SamplingMap map_from_layout(Layout layout);

}  // namespace gazetrace
