// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/fill_squares.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "reconstruct/surface_gather.hpp"

namespace gazetrace {
namespace {

// The pixels of a region between four blocks of its own size: [x, x_end) x [y, y_end), cut by the frame.
struct Square {
  int column, row;  // the upper left of the blocks
  int x, y, x_end, y_end;
};

// Fills the pixels of one region that need filtering, square by square.
class SquareFiller {
 public:
  SquareFiller(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings,
               const SurfaceLookup& lookup, std::size_t region, SurfacePicture& picture)
      : input_(input),
        map_(input.map),
        guides_(*input.guides),
        lattice_(lattice),
        settings_(settings),
        lookup_(lookup),
        region_(region),
        block_(input.map.regions[region].block_px),
        picture_(picture) {}

  void fill(const Square& square) {
    for (int y = square.y; y < square.y_end; ++y) {
      for (int x = square.x; x < square.x_end; ++x) {
        if (map_.region(x, y) == region_) {
          put(x, y);
          if (pixels_.count == kGatherLanes) {
            flush(square);
          }
        }
      }
    }
    if (pixels_.count > 0) {
      flush(square);
    }
  }

 private:
  void put(int x, int y) {
    const std::size_t i = pixels_.count++;
    const std::size_t p = picture_.radiance.index(x, y);
    at_[i] = {x, y};
    pixels_.x_px[i] = static_cast<float>(x) + 0.5F - 0.5F * static_cast<float>(map_.width_px);
    pixels_.y_px[i] = static_cast<float>(y) + 0.5F - 0.5F * static_cast<float>(map_.height_px);
    pixels_.depth_m[i] = guides_.depth_m.pixels[p];
    const Vec3f& normal = guides_.normal.pixels[p];
    pixels_.normal_x[i] = normal.x;
    pixels_.normal_y[i] = normal.y;
    pixels_.normal_z[i] = normal.z;
    pixels_.kind[i] = static_cast<std::int32_t>(guides_.kind.pixels[p]);
  }

  void flush(const Square& square) {
    const auto size = static_cast<float>(block_);
    locate_lanes(
        guides_.camera, (static_cast<float>(square.column) + 0.5F) * size - 0.5F * static_cast<float>(map_.width_px),
        (static_cast<float>(square.row) + 0.5F) * size - 0.5F * static_cast<float>(map_.height_px), size, pixels_);
    LightLanes sums;
    for (int k = 0; k < (block_ > 1 ? 4 : 1); ++k) {  // a single pixel is its own block's centre
      for_each_cell_of_block(
          lattice_, region_, square.column + (k & 1), square.row + (k >> 1),
          [&](const SurfaceCell& cell) { add_cell(cell, static_cast<std::size_t>(k), pixels_, settings_, sums); });
    }
    divide_light(sums);
    for (std::size_t i = 0; i < pixels_.count; ++i) {
      store(at_[i].x, at_[i].y, sums, i);
    }
    pixels_.count = 0;
  }

  void store(int x, int y, const LightLanes& sums, std::size_t i) {
    const std::size_t p = picture_.radiance.index(x, y);
    const Vec3f& albedo = guides_.albedo.pixels[p];
    PixelValue value{guides_.emission.pixels[p]};
    const bool reflects = !only_shines(guides_.kind.pixels[p]);
    if (reflects && enough_alike(sums.weight[i], sums.all[i])) {
      value.radiance += albedo * Vec3f{sums.reflected_r[i], sums.reflected_g[i], sums.reflected_b[i]};
      const float shade_of = luminance(albedo);
      value.variance = shade_of * shade_of * sums.variance[i];
      value.replica = shade_of * sums.replica[i];
      value.error = shade_of * shade_of * sums.error[i];
    } else if (reflects) {
      value = shaded(lookup_.farther(x, y, lookup_.surface_of(x, y)), albedo, value.radiance,
                     [&] { return input_.values.value(lattice_.site_of_pixel(x, y)); });
    }
    picture_.put(p, value);
  }

  const FilterInput& input_;
  const SamplingMap& map_;
  const Guides& guides_;
  const SurfaceCells& lattice_;
  const SmoothingSettings& settings_;
  const SurfaceLookup& lookup_;
  std::size_t region_;
  int block_;
  SurfacePicture& picture_;
  SurfaceLanes pixels_;
  struct Place {
    int x, y;
  };
  std::array<Place, kGatherLanes> at_{};
};

// Rows of squares that hold pixels of a region.
struct SquareRow {
  std::size_t region;
  int row, first_column, end_column;
};

std::vector<SquareRow> rows_of_squares(const SurfaceCells& lattice, const SamplingMap& map) {
  std::vector<SquareRow> rows;
  for (std::size_t r = 0; r < map.regions.size(); ++r) {
    // A block's pixels lie in the squares before and after its middle.
    const int before = map.regions[r].block_px > 1 ? 1 : 0;
    const BlockExtent& own = lattice.blocks[r].own();
    for (int row = own.y - before; own.y < own.y_end && row < own.y_end; ++row) {
      rows.push_back({r, row, own.x - before, own.x_end});
    }
  }
  return rows;
}

}  // namespace

void fill_squares(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings,
                  const SurfaceLookup& lookup, SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  const std::vector<SquareRow> rows = rows_of_squares(lattice, map);
  parallel_for(rows.size(), input.threads, [&](std::size_t k) {
    const SquareRow& row = rows[k];
    const int block = map.regions[row.region].block_px;
    const auto begin = [&](int at) { return at * block + block / 2; };
    SquareFiller filler(input, lattice, settings, lookup, row.region, picture);
    for (int column = row.first_column; column < row.end_column; ++column) {
      filler.fill({column, row.row, std::max(begin(column), 0), std::max(begin(row.row), 0),
                   std::min(begin(column + 1), map.width_px), std::min(begin(row.row + 1), map.height_px)});
    }
  });
}

}  // namespace gazetrace
