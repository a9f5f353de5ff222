// SPDX-License-Identifier: Apache-2.0
// The part of a region's grid of blocks that its residuals are smoothed over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reconstruct/filter.hpp"

namespace gazetrace {

// The blocks of a region and some around them: [x, x + width) x [y, y + height) on the grid of the region.
struct BlockWindow {
  std::size_t region;
  int block_px, x, y, width, height;
};

// Of each region; empty where it has no sites.
std::vector<BlockWindow> windows_of_regions(const SamplingMap& map);

// The site that stands for each block of a window: the region's own; where the region has no pixel, that in the middle.
std::vector<std::uint32_t> sites_of_blocks(const FilterInput& input, const BlockWindow& window,
                                           const Image<std::uint32_t>& site_of_pixel);

}  // namespace gazetrace
