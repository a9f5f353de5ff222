// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise in the place of guided's smoothing: pixels take up the light of the surfaces about them as
// in guided, and the network smooths the picture by what the first hits say of albedo and normal. Pixels that guided
// leaves alone keep their own mean, bit by bit. Built where the library is found.
#include "reconstruct/filter.hpp"

#ifdef GAZETRACE_WITH_OIDN

#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/open_image_denoise.hpp"

namespace gazetrace {

Frame filter_oidn(const FilterInput& input) {
  const SamplingMap& map = input.map;
  Frame frame = frame_from_surfaces(input, false);
  const ImageRgb smooth = open_image_denoise(frame.radiance, input.guides->albedo, input.guides->normal, input.threads);
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (needs_filtering(map, map.sites[i])) {
        for_each_pixel(map, map.sites[i], [&](int x, int y) { frame.radiance(x, y) = smooth(x, y); });
      }
    }
  });
  return frame;
}

}  // namespace gazetrace

#endif
