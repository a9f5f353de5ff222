// SPDX-License-Identifier: Apache-2.0
// What the sites of a map say about the pixels of a frame and the blocks of a region.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "foveation/sites.hpp"

namespace gazetrace {

// All pixels of a site have the value value_of(index of the site), those that are in none have `elsewhere`.
template <class Value>
ImageGray image_of_sites(const SamplingMap& map, const Value& value_of, float elsewhere = 0) {
  ImageGray image(map.width_px, map.height_px, elsewhere);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const float value = value_of(i);
    for_each_pixel(map, map.sites[i], [&](int x, int y) { image(x, y) = value; });
  }
  return image;
}

// Samples a pixel that every pixel of the frame expects: blocks share what theirs does.
ImageGray expected_spp_of(const SamplingMap& map);

// The index of the site that each pixel belongs to.
Image<std::uint32_t> sites_of_pixels(const SamplingMap& map, int threads);

// On a region's grid of blocks: [x, x_end) x [y, y_end).
struct BlockExtent {
  int x = 0, y = 0, x_end = 0, y_end = 0;
};
// Of each region, the extent of the blocks that have a site of it; all 0 where there is none.
std::vector<BlockExtent> extents_of_blocks(const SamplingMap& map);

}  // namespace gazetrace
