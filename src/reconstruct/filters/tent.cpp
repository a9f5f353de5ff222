// SPDX-License-Identifier: Apache-2.0
// Normalised convolution (Knutsson and Westin, "Normalized and Differential Convolution", CVPR 1993) with a tent:
//   radiance(p) = sum w m / sum w,   w = samples per pixel * tent((p - c) / r) in x and y,   r = 1.5 blocks
// with m the mean of a site and c its block's centre. Sites are met on a lattice of half blocks of the pixel's own
// site, so that a finer neighbour counts by the area it covers and not by its number of sites. Pixels of 1x1 sites with
// samples are left alone.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {
namespace {

class TentFilter {
 public:
  TentFilter(const FilterInput& input, Frame& frame)
      : input_(input), frame_(frame), site_of_pixel_(sites_of_pixels(input.map, input.threads)) {}

  void fill_site(std::size_t i) const {
    const SamplingMap& map = input_.map;
    const Site& site = map.sites[i];
    paint_site(frame_, map, input_.values, i);
    const int block = map.regions[site.region].block_px;
    if (block > 1) {
      for_each_pixel(map, site, [&](int x, int y) { fill_pixel(x, y, block); });
    }
  }

 private:
  struct Sums {
    Vec3f radiance, albedo, normal;
    float variance = 0, depth = 0, hits = 0, weight = 0;
  };

  void fill_pixel(int x, int y, int block) const {
    const SamplingMap& map = input_.map;
    const float half = 0.5F * static_cast<float>(block);
    Sums sums;
    for (int dy = -3; dy <= 3; ++dy) {
      const int py = static_cast<int>(std::floor(static_cast<float>(y) + 0.5F + static_cast<float>(dy) * half));
      for (int dx = -3; dx <= 3; ++dx) {
        const int px = static_cast<int>(std::floor(static_cast<float>(x) + 0.5F + static_cast<float>(dx) * half));
        if (px >= 0 && py >= 0 && px < map.width_px && py < map.height_px) {
          add(x, y, block, site_of_pixel_(px, py), sums);
        }
      }
    }
    if (!(sums.weight > 0)) {
      return;
    }
    const std::size_t p = frame_.radiance.index(x, y);
    const float scale = 1.0F / sums.weight;
    frame_.radiance.pixels[p] = sums.radiance * scale;
    frame_.variance.pixels[p] = sums.variance * scale * scale;
    if (input_.values.has_guides()) {
      frame_.albedo.pixels[p] = sums.albedo * scale;
      frame_.normal.pixels[p] = sums.normal * scale;
      if (frame_.depth_m.pixels[p] < std::numeric_limits<float>::infinity() && sums.hits > 0) {
        frame_.depth_m.pixels[p] = sums.depth / sums.hits;
      }
    }
  }

  void add(int x, int y, int block, std::uint32_t index, Sums& sums) const {
    const SamplingMap& map = input_.map;
    const Site& site = map.sites[index];
    const auto size = static_cast<float>(map.regions[site.region].block_px);
    const float reach = 1.5F * static_cast<float>(block);
    const float across = static_cast<float>(x) + 0.5F - (static_cast<float>(site.block_x) + 0.5F) * size;
    const float down = static_cast<float>(y) + 0.5F - (static_cast<float>(site.block_y) + 0.5F) * size;
    const float tent =
        std::max(1.0F - std::fabs(across) / reach, 0.0F) * std::max(1.0F - std::fabs(down) / reach, 0.0F);
    const float w = tent * static_cast<float>(input_.values.count(index)) / static_cast<float>(site.pixels);
    if (!(w > 0)) {
      return;
    }
    const SiteValue value = input_.values.value(index);
    sums.weight += w;
    sums.radiance += w * value.radiance;
    sums.variance += w * w * value.variance;
    if (input_.values.has_guides()) {
      const SiteGuides guides = input_.values.guides(index);
      sums.albedo += w * guides.albedo;
      sums.normal += w * guides.normal;
      if (guides.hit_share > 0) {
        sums.hits += w * guides.hit_share;
        sums.depth += w * guides.hit_share * guides.depth_m;
      }
    }
  }

  const FilterInput& input_;
  Frame& frame_;
  Image<std::uint32_t> site_of_pixel_;
};

Frame convolve(const FilterInput& input) {
  Frame frame = make_frame(input.map, input.values.has_guides());
  const TentFilter filter(input, frame);
  parallel_for(input.map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = input.map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      filter.fill_site(i);
    }
  });
  return frame;
}

}  // namespace

const FilterDefinition filter_tent{.frame = convolve};

}  // namespace gazetrace
