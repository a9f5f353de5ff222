// SPDX-License-Identifier: Apache-2.0
// Divides the sites of a map into pieces of work, each for one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {

struct SiteRange {
  std::uint32_t first = 0, count = 0;
};

// The sites of all tiles, in the map's order: a tile, or parts of one where a frame has too few of them to keep all
// cores busy. With `only_pixel` the site that contains that pixel, and an empty range where it is outside the frame.
std::vector<SiteRange> site_ranges(const SamplingMap& map, const std::optional<PixelIndex>& only_pixel);

}  // namespace gazetrace
