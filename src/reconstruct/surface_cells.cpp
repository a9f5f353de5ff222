// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_cells.hpp"

#include <algorithm>
#include <cmath>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/site_images.hpp"

namespace gazetrace {
namespace {

SurfaceCell cell_of(const SurfaceSums& sums, float block_px, float pixel_m, bool perspective) {
  const auto n = static_cast<float>(sums.count);
  SurfaceCell cell;
  cell.reflected = sums.reflected / n;
  cell.albedo = sums.albedo / n;
  const float squared = dot(sums.normal, sums.normal);
  cell.normal = squared > 0 ? sums.normal * (1.0F / std::sqrt(squared)) : Vec3f{};
  cell.position_m = sums.position_m / n;
  cell.samples = n;
  const float distance = perspective ? std::sqrt(dot(cell.position_m, cell.position_m)) : 1.0F;
  cell.footprint_m = block_px * pixel_m * distance;
  cell.light = luminance(cell.reflected) / std::max(luminance(cell.albedo), kLeastAlbedo);
  cell.square = sums.square / n;
  cell.replica = sums.half_difference / std::max(luminance(cell.albedo), kLeastAlbedo);
  cell.kind = sums.kind;
  return cell;
}

std::uint32_t code_of_site(const SurfaceCells& cells, std::size_t site) {
  return cells.first[site] << 2U | (cells.first[site + 1] - cells.first[site]);
}

void fill_from_middles(const SurfaceCells& cells, const SamplingMap& map, int block_px, int threads,
                       BlockCells& blocks) {
  const BlockExtent& own = blocks.own();
  if (own.x == own.x_end) {
    return;
  }
  const auto in_frame = [block_px](int end, int frame_px) {
    return std::min(end + BlockCells::kReach, (frame_px + block_px - 1) / block_px);
  };
  const int x_end = in_frame(own.x_end, map.width_px);
  const int y_end = in_frame(own.y_end, map.height_px);
  const int y_begin = std::max(own.y - BlockCells::kReach, 0);
  parallel_for(static_cast<std::size_t>(y_end - y_begin), threads, [&](std::size_t row) {
    const int by = y_begin + static_cast<int>(row);
    const int py = std::min(by * block_px + block_px / 2, map.height_px - 1);
    for (int bx = std::max(own.x - BlockCells::kReach, 0); bx < x_end; ++bx) {
      const int px = std::min(bx * block_px + block_px / 2, map.width_px - 1);
      blocks.at(bx, by) = code_of_site(cells, cells.site_of_pixel(px, py));
    }
  });
}

std::vector<BlockCells> cells_of_blocks(const SurfaceCells& cells, const SamplingMap& map, int threads) {
  std::vector<BlockCells> blocks;
  for (const BlockExtent& own : extents_of_blocks(map)) {
    const int block_px = map.regions[blocks.size()].block_px;
    fill_from_middles(cells, map, block_px, threads, blocks.emplace_back(own));
  }
  parallel_for(map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      blocks[site.region].at(site.block_x, site.block_y) = code_of_site(cells, i);
    }
  });
  return blocks;
}

}  // namespace

BlockCells::BlockCells(const BlockExtent& own) : own_(own) {
  if (own.x < own.x_end) {
    width_ = own.x_end - own.x + 2 * kReach;
    codes_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(own.y_end - own.y + 2 * kReach), 0);
  }
}

SurfaceCells make_surface_cells(const SparseFrame& sparse, const SamplingMap& map, const GuideCamera& camera,
                                int threads) {
  SurfaceCells out;
  out.first = sparse.first_surface;
  out.cells.resize(sparse.surfaces.size());
  out.site_of_pixel = Image<std::uint32_t>(map.width_px, map.height_px);
  const float pixel_m = std::sqrt(dot(camera.up_step, camera.up_step));
  parallel_for(map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const auto block = static_cast<float>(map.regions[map.sites[i].region].block_px);
      for_each_pixel(map, map.sites[i], [&](int x, int y) { out.site_of_pixel(x, y) = static_cast<std::uint32_t>(i); });
      for (std::size_t s = out.first[i]; s < out.first[i + 1]; ++s) {
        out.cells[s] = cell_of(sparse.surfaces[s], block, pixel_m, camera.perspective);
      }
    }
  });
  out.blocks = cells_of_blocks(out, map, threads);
  return out;
}

}  // namespace gazetrace
