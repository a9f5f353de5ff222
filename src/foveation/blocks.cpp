// SPDX-License-Identifier: Apache-2.0
#include "foveation/blocks.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr int kTilePx = 64;
constexpr int kGlancePx = 8;

struct TileBlocks {
  std::vector<Site> sites;
  std::vector<double> weights;
};

// Divides one tile into blocks, in Z order.
class BlockCutter {
 public:
  BlockCutter(const DensityField& field, const FoveationSettings& settings, double full_rate_spp,
              Image<std::uint8_t>& region, TileBlocks& out)
      : field_(field),
        full_rate_spp_(full_rate_spp),
        wanted_(std::min(settings.block_samples, full_rate_spp)),
        max_block_px_(settings.max_block_px),
        region_(region),
        out_(out) {}

  void cut(int x, int y, int side) {
    if (x >= region_.width_px || y >= region_.height_px) {
      return;
    }
    if (side > max_block_px_) {
      quarter(x, y, side);
      return;
    }
    if (side == 1) {
      add(x, y, 1, field_.at(x + 0.5, y + 0.5));
      return;
    }
    const DensityField::Bounds density = field_.within(x, y, side);
    if (expects_enough(density.least, 1)) {
      all_pixels(x, y, side, density.least == 1);
    } else if (expects_enough(density.most, side / 2)) {
      quarter(x, y, side);
    } else {
      const int x_end = std::min(x + side, region_.width_px);
      const int y_end = std::min(y + side, region_.height_px);
      add(x, y, side, field_.over(x, y, x_end, y_end));
    }
  }

 private:
  [[nodiscard]] bool expects_enough(double density, int side) const {
    return density * full_rate_spp_ * (static_cast<double>(side) * side) >= wanted_;
  }

  void quarter(int x, int y, int side) {
    const int half = side / 2;
    cut(x, y, half);
    cut(x + half, y, half);
    cut(x, y + half, half);
    cut(x + half, y + half, half);
  }

  // Every block in the square is known to be a pixel, so bounds need not be computed any more.
  void all_pixels(int x, int y, int side, bool full_rate) {
    if (x >= region_.width_px || y >= region_.height_px) {
      return;
    }
    if (side == 1) {
      add(x, y, 1, full_rate ? 1.0 : field_.at(x + 0.5, y + 0.5));
      return;
    }
    const int half = side / 2;
    all_pixels(x, y, half, full_rate);
    all_pixels(x + half, y, half, full_rate);
    all_pixels(x, y + half, half, full_rate);
    all_pixels(x + half, y + half, half, full_rate);
  }

  void add(int x, int y, int side, double density) {
    const int x_end = std::min(x + side, region_.width_px);
    const int y_end = std::min(y + side, region_.height_px);
    Site site;
    site.block_x = static_cast<std::uint16_t>(x / side);
    site.block_y = static_cast<std::uint16_t>(y / side);
    site.pixels = static_cast<std::uint16_t>((x_end - x) * (y_end - y));
    site.region = static_cast<std::uint8_t>(std::countr_zero(static_cast<unsigned>(side)));
    for (int row = y; row < y_end; ++row) {
      std::fill_n(&region_(x, row), x_end - x, site.region);
    }
    out_.sites.push_back(site);
    out_.weights.push_back(density * site.pixels);
  }

  const DensityField& field_;
  double full_rate_spp_, wanted_;
  int max_block_px_;
  Image<std::uint8_t>& region_;
  TileBlocks& out_;
};

}  // namespace

WeighedMap blocks_of_density(const DensityField& field, const FoveationSettings& settings, int width_px, int height_px,
                             double full_rate_spp, int threads) {
  WeighedMap result;
  SamplingMap& map = result.map;
  map.width_px = width_px;
  map.height_px = height_px;
  map.region = Image<std::uint8_t>(width_px, height_px);
  for (int side = 1; side <= settings.max_block_px; side *= 2) {
    map.regions.push_back({"block_" + std::to_string(side), side, 0, 0, 0, 0});
  }
  const int columns = (width_px + kTilePx - 1) / kTilePx;
  const int rows = (height_px + kTilePx - 1) / kTilePx;
  std::vector<TileBlocks> tiles(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const auto column_of = [columns](std::size_t tile) { return static_cast<int>(tile) % columns; };
  const auto row_of = [columns](std::size_t tile) { return static_cast<int>(tile) / columns; };
  parallel_for(tiles.size(), threads, [&](std::size_t t) {
    BlockCutter(field, settings, full_rate_spp, map.region, tiles[t])
        .cut(column_of(t) * kTilePx, row_of(t) * kTilePx, kTilePx);
  });

  std::size_t sites = 0;
  for (const TileBlocks& tile : tiles) {
    sites += tile.sites.size();
  }
  map.sites.reserve(sites);
  result.weights.reserve(sites);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    MapTile tile;
    tile.x_px = column_of(t) * kTilePx;
    tile.y_px = row_of(t) * kTilePx;
    tile.width_px = std::min(kTilePx, width_px - tile.x_px);
    tile.height_px = std::min(kTilePx, height_px - tile.y_px);
    tile.first_site = static_cast<std::uint32_t>(map.sites.size());
    tile.site_count = static_cast<std::uint32_t>(tiles[t].sites.size());
    map.sites.insert(map.sites.end(), tiles[t].sites.begin(), tiles[t].sites.end());
    result.weights.insert(result.weights.end(), tiles[t].weights.begin(), tiles[t].weights.end());
    map.tiles.push_back(tile);
  }
  for (const Site& site : map.sites) {
    MapRegion& region = map.regions[site.region];
    region.pixels += site.pixels;
    region.sites += 1;
  }
  return result;
}

double sum_of_density(const DensityField& field, int width_px, int height_px, int threads) {
  const auto rows = static_cast<std::size_t>((height_px + kGlancePx - 1) / kGlancePx);
  std::vector<double> sums(rows);
  parallel_for(rows, threads, [&](std::size_t row) {
    const int y = static_cast<int>(row) * kGlancePx;
    const int y_end = std::min(y + kGlancePx, height_px);
    for (int x = 0; x < width_px; x += kGlancePx) {
      const int x_end = std::min(x + kGlancePx, width_px);
      sums[row] += field.over(x, y, x_end, y_end) * (x_end - x) * (y_end - y);
    }
  });
  double sum = 0;
  for (const double row : sums) {
    sum += row;
  }
  return sum;
}

}  // namespace gazetrace
