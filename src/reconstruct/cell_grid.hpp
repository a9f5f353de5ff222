// SPDX-License-Identifier: Apache-2.0
// A region's sites on the region's own block grid, so that neighbours are found by index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/reconstruct.hpp"
#include "reconstruct/site_values.hpp"

namespace gazetrace {

enum class CellKind : std::uint8_t {
  missing,     // nothing is known here
  whole,       // a site that covers its block: its centroid is the block's centre
  part,        // a site that covers a part of its block
  substitute,  // it has no pixel of the region, and stands for what the sites of other regions say about its pixels
};

// The value of a block and the point where it sits.
struct Cell {
  Vec3f radiance;
  float variance = 0;
  float count = 0;  // samples
  std::uint16_t pixels = 0;
  CellKind kind = CellKind::missing;
  float x_px = 0, y_px = 0;
};

struct CellGrid {
  int block_px = 1;
  int x = 0, y = 0, width = 0, height = 0;  // in blocks: the rectangle that `cells` covers
  std::vector<Cell> cells;
  std::vector<SiteGuides> guides;  // beside the cells; empty without guides

  [[nodiscard]] bool holds(int bx, int by) const { return bx >= x && by >= y && bx < x + width && by < y + height; }
  // holds(bx, by) must be true.
  [[nodiscard]] std::size_t index(int bx, int by) const {
    return static_cast<std::size_t>(by - y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(bx - x);
  }
};

// One grid for each region of the map. Regions of single pixels have no cells; they are painted into `frame` instead.
// Every cell that touches one of a region's sites, corners included, and lies in the frame has a value. Where the
// region itself has none (beyond its border) the cell is a substitute:
//   value     the mean of the sites of other regions in it, weighted by samples per pixel times pixels
//   place     the same mean of their centroids, so that a ramp goes through the border to a finer region unbent; moved
//             into the cell where a coarser site's centroid lies outside, so that neighbours always bracket a pixel
//   count     the samples in it, but no more than a full block of the region: a finer neighbour, sampled many times
//             more densely, must not pull the picture towards itself
std::vector<CellGrid> make_cell_grids(const SiteValues& values, const SamplingMap& map, Frame& frame, int threads);

}  // namespace gazetrace
