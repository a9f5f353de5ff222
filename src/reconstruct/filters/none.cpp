// SPDX-License-Identifier: Apache-2.0
// Each site's mean, constant over the site's pixels: what the samples say, with nothing added.
#include "core/parallel.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {

namespace {

Frame paint_sites(const FilterInput& input) {
  const SiteValues& values = input.values;
  const SamplingMap& map = input.map;
  Frame frame = make_frame(map, values.has_guides());
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
      paint_site(frame, map, values, site);
    }
  });
  return frame;
}

}  // namespace

const FilterDefinition filter_none{.frame = paint_sites};

}  // namespace gazetrace
