// SPDX-License-Identifier: Apache-2.0
// A pyramid (Gortler et al., "The Lumigraph", SIGGRAPH 1996, section 3.4; Grossman and Dally 1998). A site enters at
// the level of its block's size, or the next finer one, with weight min(1, samples / kFullSamples); one whose block is
// no power of two enters every cell that it covers, in proportion to the covered area.
//   push: a coarser cell is the weighted mean of its four children and of the sites that enter there; its weight is the
//         sum of theirs, at most 1
//   pull: from the coarsest level down, value = w value + (1 - w) (coarser level, bilinear)
// Pixels of 1x1 sites with samples are left alone.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {
namespace {

constexpr float kFullSamples = 8;

struct PyramidCell {
  Vec3f radiance;  // times weight while it is pushed
  float weight = 0;
};
using PyramidLevel = Image<PyramidCell>;

std::vector<PyramidLevel> empty_pyramid(int width, int height) {
  std::vector<PyramidLevel> levels;
  for (;;) {
    levels.emplace_back(width, height);
    if (width == 1 && height == 1) {
      return levels;
    }
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
}

void normalize(PyramidLevel& level) {
  for (PyramidCell& cell : level.pixels) {
    if (cell.weight > 0) {
      cell.radiance = cell.radiance / cell.weight;
      cell.weight = std::min(cell.weight, 1.0F);
    }
  }
}

void push(const PyramidLevel& fine, PyramidLevel& coarse) {
  for (int y = 0; y < fine.height_px; ++y) {
    for (int x = 0; x < fine.width_px; ++x) {
      const PyramidCell& cell = fine(x, y);
      PyramidCell& parent = coarse(x / 2, y / 2);
      parent.radiance += cell.weight * cell.radiance;
      parent.weight += cell.weight;
    }
  }
}

Vec3f bilinear(const PyramidLevel& level, float u, float v) {
  const int x = static_cast<int>(std::floor(u));
  const int y = static_cast<int>(std::floor(v));
  const float fx = u - static_cast<float>(x);
  const float fy = v - static_cast<float>(y);
  const auto at = [&](int i, int j) {
    return level(std::clamp(i, 0, level.width_px - 1), std::clamp(j, 0, level.height_px - 1)).radiance;
  };
  return (at(x, y) * (1.0F - fx) + at(x + 1, y) * fx) * (1.0F - fy) +
         (at(x, y + 1) * (1.0F - fx) + at(x + 1, y + 1) * fx) * fy;
}

void pull(const PyramidLevel& coarse, PyramidLevel& fine, int threads) {
  parallel_for(static_cast<std::size_t>(fine.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < fine.width_px; ++x) {
      PyramidCell& cell = fine(x, y);
      if (cell.weight < 1) {
        const Vec3f below = bilinear(coarse, (static_cast<float>(x) + 0.5F) * 0.5F - 0.5F,
                                     (static_cast<float>(y) + 0.5F) * 0.5F - 0.5F);
        cell.radiance = cell.radiance * cell.weight + below * (1.0F - cell.weight);
      }
    }
  });
}

// Parts of a site's pixels in the cells of a level.
class CellShares {
 public:
  struct Share {
    int x, y;
    int pixels;
  };
  const std::vector<Share>& of(const SamplingMap& map, const Site& site, std::size_t level) {
    shares_.clear();
    for_each_pixel(map, site, [&](int px, int py) {
      const int x = px >> level;
      const int y = py >> level;
      const auto found = std::find_if(shares_.begin(), shares_.end(),
                                      [&](const Share& share) { return share.x == x && share.y == y; });
      if (found == shares_.end()) {
        shares_.push_back({x, y, 1});
      } else {
        ++found->pixels;
      }
    });
    return shares_;
  }

 private:
  std::vector<Share> shares_;
};

Frame fill_from_pyramid(const FilterInput& input) {
  const SamplingMap& map = input.map;
  // AOVs, variances and counts are those of the linear filter; the light is put in its place.
  Frame frame = filter_linear.frame(input);
  std::vector<PyramidLevel> levels = empty_pyramid(map.width_px, map.height_px);
  CellShares shares;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const Site& site = map.sites[i];
    const auto block = static_cast<unsigned>(map.regions[site.region].block_px);
    const std::size_t level =
        std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(block)) - 1, levels.size() - 1);
    const auto count = static_cast<float>(input.values.count(i));
    const float weight = std::min(count / kFullSamples, 1.0F);
    const Vec3f radiance = input.values.value(i).radiance;
    const auto enter = [&](int x, int y, float part) {
      levels[level](x, y).radiance += part * radiance;
      levels[level](x, y).weight += part;
    };
    if (std::has_single_bit(block)) {
      const int side = static_cast<int>(block);
      enter(site.block_x * side >> level, site.block_y * side >> level, weight);
      continue;
    }
    // At a border the part of a block that is there stands for the whole block, as with powers of two.
    const auto side = static_cast<float>(block);
    const float cells = side * side / static_cast<float>(std::size_t{1} << (2 * level));
    for (const CellShares::Share& share : shares.of(map, site, level)) {
      const float covered = cells * static_cast<float>(share.pixels) / static_cast<float>(site.pixels);
      enter(share.x, share.y, weight * std::min(covered, 1.0F));
    }
  }
  for (std::size_t k = 0; k < levels.size(); ++k) {
    normalize(levels[k]);
    if (k + 1 < levels.size()) {
      push(levels[k], levels[k + 1]);
    }
  }
  if (!(levels.back()(0, 0).weight > 0)) {
    return frame;  // no samples at all
  }
  levels.back()(0, 0).weight = 1;
  for (std::size_t k = levels.size() - 1; k > 0; --k) {
    pull(levels[k], levels[k - 1], input.threads);
  }
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (map.regions[map.sites[i].region].block_px > 1 || input.values.count(i) == 0) {
        for_each_pixel(map, map.sites[i], [&](int x, int y) { frame.radiance(x, y) = levels[0](x, y).radiance; });
      }
    }
  });
  return frame;
}

}  // namespace

const FilterDefinition filter_push_pull{.frame = fill_from_pyramid};

}  // namespace gazetrace
