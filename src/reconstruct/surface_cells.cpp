// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_cells.hpp"

#include <algorithm>
#include <cmath>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"

namespace gazetrace {
namespace {

SurfaceCell cell_of(const SurfaceSums& sums, float block_px, float pixel_m, bool perspective) {
  const auto n = static_cast<float>(sums.count);
  SurfaceCell cell;
  cell.reflected = sums.reflected / n;
  cell.albedo = sums.albedo / n;
  const float squared = dot(sums.normal, sums.normal);
  cell.normal = squared > 0 ? sums.normal * (1.0F / std::sqrt(squared)) : Vec3f{};
  cell.place_m = sums.place_m / n;
  cell.samples = n;
  const float distance = perspective ? std::sqrt(dot(cell.place_m, cell.place_m)) : 1.0F;
  cell.footprint_m = block_px * pixel_m * distance;
  cell.light = luminance(cell.reflected) / std::max(luminance(cell.albedo), kLeastAlbedo);
  cell.square = sums.square / n;
  cell.kind = sums.kind;
  return cell;
}

}  // namespace

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
  return out;
}

}  // namespace gazetrace
