// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/z_order.hpp"

#include <algorithm>
#include <cstddef>

namespace gazetrace {
namespace {

// The bits of x and y in turn: the place on a Z-curve.
std::uint64_t interleave(std::uint32_t x, std::uint32_t y) {
  std::uint64_t code = 0;
  for (unsigned bit = 0; bit < 16; ++bit) {
    code |= std::uint64_t{x >> bit & 1U} << (2 * bit) | std::uint64_t{y >> bit & 1U} << (2 * bit + 1);
  }
  return code;
}

}  // namespace

ZOrder::ZOrder(const SamplingMap& map) : map_(&map) {
  std::uint64_t most = 1;
  for (const MapTile& tile : map.tiles) {
    most = std::max(most, tile.samples);
  }
  while ((std::uint64_t{1} << tile_bits_) < most) {
    ++tile_bits_;
  }
}

std::uint64_t ZOrder::first_index(std::uint32_t site) const {
  const auto after = std::upper_bound(map_->tiles.begin(), map_->tiles.end(), site,
                                      [](std::uint32_t s, const MapTile& tile) { return s < tile.first_site; });
  if (after == map_->tiles.begin()) {
    return 0;
  }
  const MapTile& tile = *(after - 1);
  // All tiles have the size of the first one, except that the last column and row may be cut off.
  const MapTile& first = map_->tiles.front();
  const auto column = static_cast<std::uint32_t>(tile.x_px / first.width_px);
  const auto row = static_cast<std::uint32_t>(tile.y_px / first.height_px);
  std::uint64_t index = interleave(column, row) << tile_bits_;
  for (std::size_t s = tile.first_site; s < site; ++s) {
    index += map_->sites[s].samples;
  }
  return index;
}

}  // namespace gazetrace
