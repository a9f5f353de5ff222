// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/blend_edges.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/parallel.hpp"

namespace gazetrace {

void blend_edges(const FilterInput& input, const SurfaceLookup& lookup, const Image<std::uint32_t>& site_of_pixel,
                 SurfacePicture& picture) {
  const Guides& guides = *input.guides;
  const std::vector<EdgeRay>& rays = guides.edge_rays;
  constexpr std::size_t kRaysPerTask = 4096;
  struct Blended {
    std::uint32_t pixel;
    PixelValue value;
  };
  std::vector<std::vector<Blended>> blended((rays.size() + kRaysPerTask - 1) / kRaysPerTask);
  const auto value_of = [&](const EdgeRay& ray) -> PixelValue {
    if (!ray.own_surface) {
      return picture.at(ray.seen_by);
    }
    const EdgeSurface& surface = guides.edge_surfaces[ray.seen_by];
    if (only_shines(surface.kind)) {
      return {surface.emission};
    }
    const std::uint32_t site = site_of_pixel.pixels[ray.pixel];
    const int x = static_cast<int>(ray.pixel) % input.map.width_px;
    const int y = static_cast<int>(ray.pixel) / input.map.width_px;
    return shaded(lookup.light_at(x, y, lookup.surface_of(surface)), surface.albedo, surface.emission,
                  [&] { return input.values.value(site); });
  };
  parallel_for(blended.size(), input.threads, [&](std::size_t task) {
    // A pixel belongs to the task in which its first ray is.
    std::size_t k = task * kRaysPerTask;
    while (k > 0 && k < rays.size() && rays[k].pixel == rays[k - 1].pixel) {
      ++k;
    }
    while (k < std::min((task + 1) * kRaysPerTask, rays.size())) {
      const std::uint32_t pixel = rays[k].pixel;
      PixelValue sum = picture.at(pixel);
      float count = 1;
      for (; k < rays.size() && rays[k].pixel == pixel; ++k) {
        const PixelValue value = value_of(rays[k]);
        sum.radiance += value.radiance;
        sum.variance += value.variance;
        sum.replica += value.replica;
        sum.error += value.error;
        ++count;
      }
      // An upper bound of the variance: the values may share their samples.
      blended[task].push_back(
          {pixel, {sum.radiance / count, sum.variance / count, sum.replica / count, sum.error / count}});
    }
  });
  parallel_for(blended.size(), input.threads, [&](std::size_t task) {
    for (const Blended& b : blended[task]) {
      picture.put(b.pixel, b.value);
    }
  });
}

}  // namespace gazetrace
