// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/cell_grid.hpp"

#include <algorithm>
#include <limits>

#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {
namespace {

// The blocks of each region and a ring around them, inside the frame.
std::vector<CellGrid> empty_grids(const SamplingMap& map, bool guides) {
  const std::vector<BlockExtent> extents = extents_of_blocks(map);
  std::vector<CellGrid> grids(map.regions.size());
  for (std::size_t r = 0; r < grids.size(); ++r) {
    CellGrid& grid = grids[r];
    const int block = map.regions[r].block_px;
    grid.block_px = block;
    const BlockExtent& own = extents[r];
    if (block == 1 || own.x == own.x_end) {
      continue;
    }
    grid.x = std::max(own.x - 1, 0);
    grid.y = std::max(own.y - 1, 0);
    grid.width = std::min(own.x_end, (map.width_px - 1) / block) - grid.x + 1;
    grid.height = std::min(own.y_end, (map.height_px - 1) / block) - grid.y + 1;
    const std::size_t cells = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
    grid.cells.resize(cells);
    grid.guides.resize(guides ? cells : 0);
  }
  return grids;
}

Cell cell_of_site(const SiteValues& values, const SamplingMap& map, std::size_t index) {
  const Site& site = map.sites[index];
  const BlockRect rect = block_rect(map, site);
  const int block = map.regions[site.region].block_px;
  const SiteValue value = values.value(index);
  Cell cell;
  cell.radiance = value.radiance;
  cell.variance = value.variance;
  cell.count = static_cast<float>(values.count(index));
  cell.pixels = site.pixels;
  cell.kind = site.pixels == block * block ? CellKind::whole : CellKind::part;
  if (site.pixels == (rect.x_end - rect.x) * (rect.y_end - rect.y)) {
    cell.x_px = 0.5F * static_cast<float>(rect.x + rect.x_end);
    cell.y_px = 0.5F * static_cast<float>(rect.y + rect.y_end);
  } else {
    double x_sum = 0;
    double y_sum = 0;
    for_each_pixel(map, site, [&](int x, int y) {
      x_sum += x + 0.5;
      y_sum += y + 0.5;
    });
    cell.x_px = static_cast<float>(x_sum / site.pixels);
    cell.y_px = static_cast<float>(y_sum / site.pixels);
  }
  return cell;
}

// A site of another region, and how many of its pixels lie in the cell.
struct Contribution {
  Cell cell;
  SiteGuides guides;
  int overlap = 0;
};

class Substitutes {
 public:
  Substitutes(const SamplingMap& map, const Frame& frame, std::vector<CellGrid>& grids)
      : map_(map), frame_(frame), grids_(grids), has_guides_(!frame.albedo.empty()) {}

  void add(std::size_t region) {
    CellGrid& grid = grids_[region];
    float full_count = 0;
    for (const Cell& cell : grid.cells) {
      full_count = std::max(full_count, cell.count);
    }
    for (int by = grid.y; by < grid.y + grid.height; ++by) {
      for (int bx = grid.x; bx < grid.x + grid.width; ++bx) {
        if (grid.cells[grid.index(bx, by)].kind == CellKind::missing && touches_site(grid, bx, by)) {
          const BlockRect rect{bx * grid.block_px, by * grid.block_px,
                               std::min((bx + 1) * grid.block_px, map_.width_px),
                               std::min((by + 1) * grid.block_px, map_.height_px)};
          gather(rect);
          blend(grid, grid.index(bx, by), rect, full_count);
        }
      }
    }
  }

 private:
  static bool touches_site(const CellGrid& grid, int bx, int by) {
    for (int y = std::max(by - 1, grid.y); y < std::min(by + 2, grid.y + grid.height); ++y) {
      for (int x = std::max(bx - 1, grid.x); x < std::min(bx + 2, grid.x + grid.width); ++x) {
        const CellKind kind = grid.cells[grid.index(x, y)].kind;
        if (kind == CellKind::whole || kind == CellKind::part) {
          return true;
        }
      }
    }
    return false;
  }

  void gather(const BlockRect& rect) {
    found_.clear();
    for (int y = rect.y; y < rect.y_end; ++y) {
      for (int x = rect.x; x < rect.x_end; ++x) {
        if (map_.regions[map_.region(x, y)].block_px == 1) {
          add_pixel(x, y);
        } else {
          add_block_pixel(map_.region(x, y), x, y);
        }
      }
    }
  }

  void add_pixel(int x, int y) {
    Contribution c;
    c.cell = {frame_.radiance(x, y), frame_.variance(x, y),        frame_.sample_count(x, y),   1,
              CellKind::whole,       static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
    if (has_guides_) {
      const float depth = frame_.depth_m(x, y);
      c.guides = {frame_.albedo(x, y), frame_.normal(x, y), depth,
                  depth < std::numeric_limits<float>::infinity() ? 1.0F : 0.0F};
    }
    c.overlap = 1;
    found_.push_back(c);
  }

  void add_block_pixel(std::uint8_t region, int x, int y) {
    const CellGrid& other = grids_[region];
    const std::size_t i = other.index(x / other.block_px, y / other.block_px);
    const Cell& cell = other.cells[i];
    for (Contribution& c : found_) {
      // A site is known by its centroid: no two share one.
      if (c.cell.x_px == cell.x_px && c.cell.y_px == cell.y_px && c.cell.pixels == cell.pixels) {
        ++c.overlap;
        return;
      }
    }
    found_.push_back({cell, has_guides_ ? other.guides[i] : SiteGuides{}, 1});
  }

  void blend(CellGrid& grid, std::size_t index, const BlockRect& rect, float full_count) const {
    double samples = 0;
    int pixels = 0;
    for (const Contribution& c : found_) {
      samples += expected_samples(c);
      pixels += c.overlap;
    }
    Vec3d radiance;
    Vec3d albedo;
    Vec3d normal;
    double variance = 0;
    double x = 0;
    double y = 0;
    double depth = 0;
    double hits = 0;
    for (const Contribution& c : found_) {
      const double w = samples > 0 ? expected_samples(c) / samples : static_cast<double>(c.overlap) / pixels;
      radiance += w * to_double(c.cell.radiance);
      variance += w * w * static_cast<double>(c.cell.variance);
      x += w * static_cast<double>(c.cell.x_px);
      y += w * static_cast<double>(c.cell.y_px);
      albedo += w * to_double(c.guides.albedo);
      normal += w * to_double(c.guides.normal);
      if (c.guides.hit_share > 0) {
        hits += w * static_cast<double>(c.guides.hit_share);
        depth += w * static_cast<double>(c.guides.hit_share) * static_cast<double>(c.guides.depth_m);
      }
    }
    grid.cells[index] = {to_float(radiance),
                         static_cast<float>(variance),
                         std::min(static_cast<float>(samples), full_count),
                         static_cast<std::uint16_t>(pixels),
                         CellKind::substitute,
                         static_cast<float>(std::clamp(x, rect.x + 0.5, rect.x_end - 0.5)),
                         static_cast<float>(std::clamp(y, rect.y + 0.5, rect.y_end - 0.5))};
    if (has_guides_) {
      SiteGuides& guides = grid.guides[index];
      guides = {to_float(albedo), to_float(normal)};
      if (hits > 0) {
        guides.depth_m = static_cast<float>(depth / hits);
        guides.hit_share = static_cast<float>(hits);
      }
    }
  }

  static double expected_samples(const Contribution& c) {
    return static_cast<double>(c.cell.count) * c.overlap / c.cell.pixels;
  }

  const SamplingMap& map_;
  const Frame& frame_;
  std::vector<CellGrid>& grids_;
  bool has_guides_;
  std::vector<Contribution> found_;
};

}  // namespace

std::vector<CellGrid> make_cell_grids(const SiteValues& values, const SamplingMap& map, Frame& frame, int threads) {
  std::vector<CellGrid> grids = empty_grids(map, values.has_guides());
  parallel_for(map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      CellGrid& grid = grids[site.region];
      if (grid.block_px == 1) {
        paint_site(frame, map, values, i);
        continue;
      }
      const std::size_t index = grid.index(site.block_x, site.block_y);
      grid.cells[index] = cell_of_site(values, map, i);
      if (values.has_guides()) {
        grid.guides[index] = values.guides(i);
      }
    }
  });
  Substitutes substitutes(map, frame, grids);
  for (std::size_t r = 0; r < grids.size(); ++r) {
    if (!grids[r].cells.empty()) {
      substitutes.add(r);
    }
  }
  return grids;
}

}  // namespace gazetrace
