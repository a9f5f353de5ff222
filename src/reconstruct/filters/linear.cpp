// SPDX-License-Identifier: Apache-2.0
// Bilinear between the centroids of neighbouring blocks, weighted by sample count.
//
// A row of blocks is a polyline through the centroids of its cells; at a pixel's x it has a value, a height and a
// count. The pixel lies between its own row's polyline and that of the row above or below, and is interpolated
// between the two at its height. Where all blocks are whole this is bilinear interpolation; where blocks straddle a
// border or the frame's edge the four weights still place the mean of the centroids on the pixel, so that a linear
// ramp comes out linear. Each weight is multiplied by its cell's samples and all are divided by their sum. Beyond the
// outermost centroids of the frame the last value is held. A pixel only takes this filter's value if its own region
// has blocks: finer regions are read (see cell_grid.hpp) and never written.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.hpp"
#include "reconstruct/cell_grid.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kRowsPerTask = 16;

template <class T>
T mix(const T& a, const T& b, float t) {
  return a + (b - a) * t;
}
float mix_variance(float a, float b, float t) {
  return (1.0F - t) * (1.0F - t) * a + t * t * b;
}

// The share of b when a and b are weighted 1 - t and t and each by its count.
float counted(float t, float count_a, float count_b) {
  const float a = (1.0F - t) * count_a;
  const float b = t * count_b;
  return a + b > 0 ? b / (a + b) : t;
}

// Two neighbours in a row of blocks, and the share of the second.
struct RowPoint {
  std::size_t a, b;
  float share;  // counted
  float y_px;   // height of the polyline
  float count;  // interpolated
};

struct Stencil {
  RowPoint near, far;
  float share;  // of `far`, counted
};

class LinearFilter {
 public:
  LinearFilter(const SamplingMap& map, const std::vector<CellGrid>& grids, Frame& frame)
      : map_(map), grids_(grids), frame_(frame) {}

  void fill_row(int y) const {
    const int width = map_.width_px;
    const std::uint8_t* regions = &map_.region(0, y);
    for (int x = 0; x < width;) {
      const std::uint8_t region = regions[x];
      int end = x + 1;
      while (end < width && regions[end] == region) {
        ++end;
      }
      if (grids_[region].block_px > 1) {
        fill_run(grids_[region], x, end, y);
      }
      x = end;
    }
  }

 private:
  // Two cells above one another, interpolated at the row's height. Usable where both are whole and equally sampled.
  struct Column {
    Vec3f radiance;
    float variance = 0;
    float count = -1;
  };

  [[nodiscard]] Column column(const CellGrid& grid, int bx, int by, int other_by, float t) const {
    if (!grid.holds(bx, by) || !grid.holds(bx, other_by)) {
      return {};
    }
    const Cell& a = grid.cells[grid.index(bx, by)];
    const Cell& b = grid.cells[grid.index(bx, other_by)];
    if (a.kind != CellKind::whole || b.kind != CellKind::whole || a.count != b.count) {
      return {};
    }
    return {mix(a.radiance, b.radiance, t), mix_variance(a.variance, b.variance, t), a.count};
  }

  // Pixels [x0, x1) of row y, all of one region.
  void fill_run(const CellGrid& grid, int x0, int x1, int y) const {
    const int block = grid.block_px;
    const auto size = static_cast<float>(block);
    const int by = y / block;
    const float below_center = static_cast<float>(y - by * block) + 0.5F - 0.5F * size;
    const int other_by = below_center < 0 ? by - 1 : by + 1;
    const float t = std::abs(below_center) / size;
    const bool guides = !grid.guides.empty();

    const int last = (x1 - 1) / block;
    int bx = x0 / block;
    Column left = column(grid, bx - 1, by, other_by, t);
    Column own = column(grid, bx, by, other_by, t);
    for (; bx <= last; ++bx) {
      const Column right = column(grid, bx + 1, by, other_by, t);
      const int first_x = bx * block;
      const int half_x = first_x + block / 2;  // from here on pixel centres are not left of the block's
      const int begin_x = std::max(x0, first_x);
      const int end_x = std::min(x1, first_x + block);
      fill_half(grid, own, left, begin_x, std::min(half_x, end_x), y);
      fill_half(grid, own, right, std::max(half_x, begin_x), end_x, y);
      const float density = own_density(grid, bx, by);
      std::fill_n(&frame_.sample_count(begin_x, y), end_x - begin_x, density);
      for (int x = begin_x; guides && x < end_x; ++x) {
        fill_guides(grid, stencil(grid, x, y), grid.guides[grid.index(bx, by)].hit_share > 0,
                    frame_.radiance.index(x, y));
      }
      left = own;
      own = right;
    }
  }

  // Pixels [x0, x1) on one side of their block's centre, between its column and the next one on that side.
  void fill_half(const CellGrid& grid, const Column& own, const Column& side, int x0, int x1, int y) const {
    if (own.count > 0 && side.count == own.count) {
      const auto size = static_cast<float>(grid.block_px);
      const float center = (static_cast<float>(x0 / grid.block_px) + 0.5F) * size;
      for (int x = x0; x < x1; ++x) {
        const float s = std::abs(static_cast<float>(x) + 0.5F - center) / size;
        frame_.radiance(x, y) = mix(own.radiance, side.radiance, s);
        frame_.variance(x, y) = mix_variance(own.variance, side.variance, s);
      }
    } else {
      for (int x = x0; x < x1; ++x) {
        fill_pixel(grid, stencil(grid, x, y), frame_.radiance.index(x, y));
      }
    }
  }

  static float own_density(const CellGrid& grid, int bx, int by) {
    const Cell& cell = grid.cells[grid.index(bx, by)];
    return cell.count / static_cast<float>(cell.pixels);
  }

  // Row `by` of the blocks at a pixel's x. The neighbour on the far side of the centroid always brackets it, since
  // cells do not overlap in x.
  [[nodiscard]] RowPoint row_point(const CellGrid& grid, int bx, int by, float x_px) const {
    const std::size_t a = grid.index(bx, by);
    const Cell& cell = grid.cells[a];
    const int other = x_px < cell.x_px ? bx - 1 : bx + 1;
    if (!grid.holds(other, by)) {  // the frame ends here
      return {a, a, 0.0F, cell.y_px, cell.count};
    }
    const std::size_t b = grid.index(other, by);
    const Cell& neighbor = grid.cells[b];
    const float t = (x_px - cell.x_px) / (neighbor.x_px - cell.x_px);
    return {a, b, counted(t, cell.count, neighbor.count), mix(cell.y_px, neighbor.y_px, t),
            mix(cell.count, neighbor.count, t)};
  }

  [[nodiscard]] Stencil stencil(const CellGrid& grid, int x, int y) const {
    const float x_px = static_cast<float>(x) + 0.5F;
    const float y_px = static_cast<float>(y) + 0.5F;
    const int bx = x / grid.block_px;
    const int by = y / grid.block_px;
    const RowPoint near = row_point(grid, bx, by, x_px);
    const int other = y_px < near.y_px ? by - 1 : by + 1;
    if (!grid.holds(bx, other)) {
      return {near, near, 0.0F};
    }
    const RowPoint far = row_point(grid, bx, other, x_px);
    const float t = (y_px - near.y_px) / (far.y_px - near.y_px);
    return {near, far, counted(t, near.count, far.count)};
  }

  void fill_pixel(const CellGrid& grid, const Stencil& s, std::size_t i) const {
    const std::vector<Cell>& c = grid.cells;
    frame_.radiance.pixels[i] = mix(mix(c[s.near.a].radiance, c[s.near.b].radiance, s.near.share),
                                    mix(c[s.far.a].radiance, c[s.far.b].radiance, s.far.share), s.share);
    float variance = 0;
    const auto cells = weights(s);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      float weight = cells[k].weight;  // of this cell in all its places: `a` and `b` may be one cell
      bool again = false;
      for (std::size_t other = 0; other < cells.size(); ++other) {
        if (other != k && cells[other].cell == cells[k].cell) {
          weight += cells[other].weight;
          again = again || other < k;
        }
      }
      variance += again ? 0.0F : weight * weight * c[cells[k].cell].variance;
    }
    frame_.variance.pixels[i] = variance;
  }

  // `own_hit`: whether the pixel's own site hit anything. If not, its depth stays infinite.
  void fill_guides(const CellGrid& grid, const Stencil& s, bool own_hit, std::size_t i) const {
    Vec3f albedo;
    Vec3f normal;
    float depth = 0;
    float hits = 0;
    for (const auto& [cell, weight] : weights(s)) {
      const SiteGuides& g = grid.guides[cell];
      albedo += weight * g.albedo;
      normal += weight * g.normal;
      if (g.hit_share > 0) {
        hits += weight * g.hit_share;
        depth += weight * g.hit_share * g.depth_m;
      }
    }
    frame_.albedo.pixels[i] = albedo;
    frame_.normal.pixels[i] = normal;
    if (own_hit && hits > 0) {
      frame_.depth_m.pixels[i] = depth / hits;
    }
  }

  struct WeightedCell {
    std::size_t cell;
    float weight;
  };
  static std::array<WeightedCell, 4> weights(const Stencil& s) {
    const float near = 1.0F - s.share;
    return {{{s.near.a, near * (1.0F - s.near.share)},
             {s.near.b, near * s.near.share},
             {s.far.a, s.share * (1.0F - s.far.share)},
             {s.far.b, s.share * s.far.share}}};
  }

  const SamplingMap& map_;
  const std::vector<CellGrid>& grids_;
  Frame& frame_;
};

Frame interpolate(const FilterInput& input) {
  const SiteValues& values = input.values;
  const SamplingMap& map = input.map;
  const int threads = input.threads;
  Frame frame = make_frame(map, values.has_guides());
  const std::vector<CellGrid> grids = make_cell_grids(values, map, frame, threads);
  const LinearFilter filter(map, grids, frame);
  const auto rows = static_cast<std::size_t>(map.height_px);
  parallel_for((rows + kRowsPerTask - 1) / kRowsPerTask, threads, [&](std::size_t task) {
    for (std::size_t y = task * kRowsPerTask; y < std::min(rows, (task + 1) * kRowsPerTask); ++y) {
      filter.fill_row(static_cast<int>(y));
    }
  });
  return frame;
}

}  // namespace

const FilterDefinition filter_linear{.frame = interpolate};

}  // namespace gazetrace
