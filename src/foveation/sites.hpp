// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foveation/falloff.hpp"

namespace gazetrace {

// The pixels of a block inside the frame: [x, x_end) x [y, y_end).
struct BlockRect {
  int x, y, x_end, y_end;
};
BlockRect block_rect(const SamplingMap& map, const Site& site);

// Cuts a layout into sites, tile by tile, and adds up the totals.
SamplingMap map_from_layout(Layout layout);

}  // namespace gazetrace
