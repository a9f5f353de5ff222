// SPDX-License-Identifier: Apache-2.0
// Makes the sites that the tracer walks from the region of each pixel, in tiles that stay in the cache.
//
// A block that straddles a border has one site for each region in it, and each of them gets the block's full tau
// (per_block). Its estimate is then as good as its neighbours', and traced counts exceed nominal ones slightly.
#include "foveation/sites.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

namespace gazetrace {
namespace {

constexpr int kTileOfSitesPx = 64;

// About 64 pixels, and a multiple of every block size where that is possible.
int tile_size(const std::vector<LayoutRegion>& regions) {
  int multiple = 1;
  for (const LayoutRegion& region : regions) {
    multiple = std::lcm(multiple, region.block_px);
    if (multiple > 2 * kTileOfSitesPx) {
      return kTileOfSitesPx;
    }
  }
  return multiple > kTileOfSitesPx ? multiple : kTileOfSitesPx / multiple * multiple;
}

struct Offset {
  std::uint8_t x, y;
};

// Every position of a size x size square along a Z-curve (Morton order), so that neighbours in the list are neighbours
// in the picture at every scale.
std::vector<Offset> z_curve(int size) {
  std::vector<Offset> order;
  order.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  unsigned side = 1;
  while (side < static_cast<unsigned>(size)) {
    side *= 2;
  }
  for (unsigned code = 0; code < side * side; ++code) {
    unsigned x = 0;
    unsigned y = 0;
    for (unsigned bit = 0; bit < 8; ++bit) {
      x |= (code >> (2 * bit) & 1U) << bit;
      y |= (code >> (2 * bit + 1) & 1U) << bit;
    }
    if (x < static_cast<unsigned>(size) && y < static_cast<unsigned>(size)) {
      order.push_back({static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)});
    }
  }
  return order;
}

class SiteBuilder {
 public:
  explicit SiteBuilder(Layout layout)
      : regions_(std::move(layout.regions)), tile_px_(tile_size(regions_)), order_(z_curve(tile_px_)) {
    map_.width_px = layout.region.width_px;
    map_.height_px = layout.region.height_px;
    map_.region = std::move(layout.region);
    for (const LayoutRegion& region : regions_) {
      aligned_ = aligned_ && tile_px_ % region.block_px == 0;
      map_.regions.push_back({region.name, region.block_px, 0, 0, 0, 0});
      std::vector<Offset> origins;
      for (const Offset& o : order_) {
        if (o.x % region.block_px == 0 && o.y % region.block_px == 0) {
          origins.push_back(o);
        }
      }
      block_origins_.push_back(std::move(origins));
    }
  }

  SamplingMap build() {
    map_.sites.reserve(expected_sites());
    for (int y = 0; y < map_.height_px; y += tile_px_) {
      for (int x = 0; x < map_.width_px; x += tile_px_) {
        add_tile(x, y);
      }
    }
    for (std::size_t r = 0; r < regions_.size(); ++r) {
      const double pixels = static_cast<double>(map_.regions[r].pixels);
      const double block = regions_[r].block_px;
      map_.regions[r].nominal_samples =
          regions_[r].tau * pixels / (regions_[r].unit == SampleUnit::per_block ? block * block : 1.0);
    }
    return std::move(map_);
  }

 private:
  // A guess from every 8th pixel of every 8th row; the vector grows where it was too small.
  [[nodiscard]] std::size_t expected_sites() const {
    if (regions_.size() == 1 && regions_[0].block_px == 1) {
      return map_.region.pixels.size();
    }
    double sites = 0;
    for (int y = 0; y < map_.height_px; y += 8) {
      for (int x = 0; x < map_.width_px; x += 8) {
        const double block = regions_[map_.region(x, y)].block_px;
        sites += 64.0 / (block * block);
      }
    }
    return static_cast<std::size_t>(1.05 * sites) + 1024;
  }

  void add_tile(int x0, int y0) {
    MapTile tile;
    tile.x_px = x0;
    tile.y_px = y0;
    tile.width_px = std::min(tile_px_, map_.width_px - x0);
    tile.height_px = std::min(tile_px_, map_.height_px - y0);
    tile.first_site = static_cast<std::uint32_t>(map_.sites.size());
    samples_ = 0;
    if (aligned_ && is_one_region(tile)) {
      add_plain_blocks(tile, map_.region(x0, y0));
    } else {
      add_mixed_blocks(tile);
    }
    tile.site_count = static_cast<std::uint32_t>(map_.sites.size()) - tile.first_site;
    tile.samples = samples_;
    map_.tiles.push_back(tile);
  }

  [[nodiscard]] bool is_one_region(const MapTile& tile) const {
    const auto width = static_cast<std::size_t>(tile.width_px);
    const std::uint8_t first = map_.region(tile.x_px, tile.y_px);
    for (int y = tile.y_px; y < tile.y_px + tile.height_px; ++y) {
      const std::uint8_t* row = &map_.region(tile.x_px, y);
      if (row[0] != first || std::memcmp(row, row + 1, width - 1) != 0) {
        return false;
      }
    }
    return true;
  }

  void add_plain_blocks(const MapTile& tile, std::uint8_t region) {
    const int block = regions_[region].block_px;
    const bool whole = tile.width_px == tile_px_ && tile.height_px == tile_px_;
    for (const Offset& o : block_origins_[region]) {
      if (whole) {
        add_site(tile.x_px + o.x, tile.y_px + o.y, region, block * block);
      } else if (o.x < tile.width_px && o.y < tile.height_px) {
        add_site(tile.x_px + o.x, tile.y_px + o.y, region,
                 std::min(block, tile.width_px - o.x) * std::min(block, tile.height_px - o.y));
      }
    }
  }

  void add_mixed_blocks(const MapTile& tile) {
    for (const Offset& o : order_) {
      const int x = tile.x_px + o.x;
      const int y = tile.y_px + o.y;
      if (x >= map_.width_px || y >= map_.height_px) {
        continue;
      }
      for (std::size_t r = 0; r < regions_.size(); ++r) {
        const int block = regions_[r].block_px;
        if (x % block == 0 && y % block == 0) {
          const int pixels = count_pixels(x, y, block, static_cast<std::uint8_t>(r));
          if (pixels != 0) {
            add_site(x, y, static_cast<std::uint8_t>(r), pixels);
          }
        }
      }
    }
  }

  [[nodiscard]] int count_pixels(int x0, int y0, int block, std::uint8_t region) const {
    const int x_end = std::min(x0 + block, map_.width_px);
    const int y_end = std::min(y0 + block, map_.height_px);
    int pixels = 0;
    for (int y = y0; y < y_end; ++y) {
      for (int x = x0; x < x_end; ++x) {
        pixels += map_.region(x, y) == region ? 1 : 0;
      }
    }
    return pixels;
  }

  void add_site(int x, int y, std::uint8_t region, int pixels) {
    const LayoutRegion& rule = regions_[region];
    Site site;
    site.block_x = static_cast<std::uint16_t>(x / rule.block_px);
    site.block_y = static_cast<std::uint16_t>(y / rule.block_px);
    site.pixels = static_cast<std::uint16_t>(pixels);
    site.region = region;
    site.samples = rule.unit == SampleUnit::per_block ? rule.tau : rule.tau * static_cast<std::uint32_t>(pixels);
    MapRegion& total = map_.regions[region];
    total.pixels += site.pixels;
    total.sites += 1;
    total.samples += site.samples;
    samples_ += site.samples;
    map_.sites.push_back(site);
  }

  std::vector<LayoutRegion> regions_;
  int tile_px_;
  std::vector<Offset> order_;
  std::vector<std::vector<Offset>> block_origins_;  // per region, for a tile whose corner is on the block grid
  bool aligned_ = true;                             // every tile's corner is on every block grid
  std::uint64_t samples_ = 0;                       // of the tile that is being built
  SamplingMap map_;
};

}  // namespace

SamplingMap map_from_layout(Layout layout) {
  return SiteBuilder(std::move(layout)).build();
}

}  // namespace gazetrace
