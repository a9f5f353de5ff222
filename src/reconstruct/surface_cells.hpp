// SPDX-License-Identifier: Apache-2.0
// What the samples of a site say about the light on each surface that they hit, ready to be smoothed over neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "foveation/site_images.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// The light is the quotient of two means: reflected radiance over albedo. Both are smoothed with the same weights and
// divided last, so that over even weights the mean of what comes out is the mean of what was traced.
struct SurfaceCell {
  Vec3f reflected, albedo;  // means over the samples
  Vec3f normal;             // unit, or zero where normals cancel
  Vec3f position_m;         // relative to the eye
  float samples = 0;
  float footprint_m = 0;  // what the site's block covers there
  float light = 0;        // luminance of reflected / albedo
  float square = 0;       // mean square of the samples' own light
  float variance = 0;     // of `light`
  float replica = 0;      // of the error of `light`: see SurfaceSums::half_difference
  SurfaceKind kind = SurfaceKind::diffuse;
};

// Which cells stand for each block of a region's grid: those of the region's own site in it, also where a border or the
// frame's edge cuts the block; where the region has no pixel in it, those of the site in the block's middle.
class BlockCells {
 public:
  static constexpr int kReach = 16;  // blocks around the region's own that may be asked for

  // Begins without cells. `own` is the extent of all blocks of the region; it is empty for a region without pixels.
  explicit BlockCells(const BlockExtent& own);

  [[nodiscard]] const BlockExtent& own() const { return own_; }
  // The index of the first cell, shifted left by two bits, and the number of cells; 0 where there are none.
  [[nodiscard]] std::uint32_t& at(int bx, int by) { return codes_[index(bx, by)]; }
  [[nodiscard]] std::uint32_t at(int bx, int by) const { return codes_[index(bx, by)]; }

 private:
  static_assert(kMostSurfaces < 4);
  [[nodiscard]] std::size_t index(int bx, int by) const {
    return static_cast<std::size_t>(by - own_.y + kReach) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(bx - own_.x + kReach);
  }

  BlockExtent own_;
  int width_ = 0;
  std::vector<std::uint32_t> codes_;
};

struct SurfaceCells {
  std::vector<SurfaceCell> cells;
  std::vector<std::uint32_t> first;  // as SparseFrame::first_surface
  Image<std::uint32_t> site_of_pixel;
  std::vector<BlockCells> blocks;  // of each region
};

// visit(cell) for the cells that stand for block (bx, by) of a region's grid.
template <class Visit>
void for_each_cell_of_block(const SurfaceCells& lattice, std::size_t region, int bx, int by, const Visit& visit) {
  const std::uint32_t code = lattice.blocks[region].at(bx, by);
  const std::uint32_t end = (code >> 2U) + (code & 3U);
  for (std::uint32_t k = code >> 2U; k < end; ++k) {
    visit(lattice.cells[k]);
  }
}

SurfaceCells make_surface_cells(const SparseFrame& sparse, const SamplingMap& map, const GuideCamera& camera,
                                int threads);

}  // namespace gazetrace
