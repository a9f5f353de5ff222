// SPDX-License-Identifier: Apache-2.0
// Light apart from texture: samples carry reflected radiance over the albedo of what they hit (surface_cells.hpp),
// which is smoothed along surfaces (surface_smoothing.hpp). Each pixel takes it from the surfaces of the nearest blocks
// that are like the one it sees, multiplies it by its own albedo and adds what it sees shining:
//   radiance(p) = emission(p) + albedo(p) * sum_c w(p, c) reflected(c) / sum_c w(p, c) albedo(c)
// Emission, misses and texture thus come from the first hits at full resolution, and no edge of theirs is smoothed.
// Sites that needs_filtering leaves out keep their own mean, bit by bit. Pixels that lie between the same four blocks
// are computed together (surface_gather.hpp); those that an edge crosses are then the mean of what their rays see,
// which most often is what a pixel beside them has (guides.hpp: EdgeRay).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/filter.hpp"
#include "reconstruct/surface_cells.hpp"
#include "reconstruct/surface_gather.hpp"
#include "reconstruct/surface_smoothing.hpp"

namespace gazetrace {
namespace {

// Where less than this share of the nearest samples is on a like surface, farther blocks are asked too.
constexpr float kEnoughLike = 0.02F;

struct Light {
  Vec3f reflected, albedo;
  float variance = 0;
  float weight = 0;
  float all = 0;  // weight without regard to likeness

  void add(float w, const SurfaceCell& cell) {
    reflected += w * cell.reflected;
    albedo += w * cell.albedo;
    variance += w * w * cell.variance;
    weight += w;
  }
};

bool enough(float weight, float all) {
  return weight > kEnoughLike * all && weight > 0;
}

struct PixelSurface {
  Vec3f normal, place_m;
  SurfaceKind kind = SurfaceKind::diffuse;
};

class Gather {
 public:
  Gather(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings)
      : map_(input.map), guides_(*input.guides), lattice_(lattice), settings_(settings) {}

  // What falls on a surface that pixel (x, y) sees; nothing (weight 0) where no sample is near.
  [[nodiscard]] Light light_at(int x, int y, int block, const PixelSurface& pixel) const {
    const Light light = nearest_four(x, y, block, pixel);
    return enough(light.weight, light.all) ? light : farther(x, y, block, pixel);
  }
  // Where the nearest four blocks have not enough.
  [[nodiscard]] Light farther(int x, int y, int block, const PixelSurface& pixel) const {
    const Light light = square(x, y, block, pixel, true);
    return light.weight > 0 ? light : square(x, y, block, pixel, false);
  }

  [[nodiscard]] PixelSurface surface_of(int x, int y) const {
    const float half_width = 0.5F * static_cast<float>(map_.width_px);
    const float half_height = 0.5F * static_cast<float>(map_.height_px);
    return {guides_.normal(x, y),
            guides_.camera.place(static_cast<float>(x) + 0.5F - half_width, static_cast<float>(y) + 0.5F - half_height,
                                 guides_.depth_m(x, y)),
            guides_.kind(x, y)};
  }
  [[nodiscard]] PixelSurface surface_of(const EdgeSurface& seen) const {
    return {seen.normal, guides_.camera.place(seen.x, seen.y, seen.depth_m), seen.kind};
  }

 private:
  void visit(int px, int py, float tent, const PixelSurface& pixel, bool alike, Light& light) const {
    const std::uint32_t site = lattice_.site_of_pixel(px, py);
    for (std::size_t k = lattice_.first[site]; k < lattice_.first[site + 1]; ++k) {
      const SurfaceCell& cell = lattice_.cells[k];
      const float w = tent * cell.samples;
      light.all += w;
      if (!alike) {
        light.add(w, cell);
      } else if (cell.kind == pixel.kind) {
        const float like = surface_likeness(pixel.normal, pixel.place_m, cell.normal, cell.place_m,
                                            0.5F * cell.footprint_m, settings_);
        if (like > 0) {
          light.add(w * like, cell);
        }
      }
    }
  }

  // Bilinear between blocks of the pixel's own size.
  [[nodiscard]] Light nearest_four(int x, int y, int block, const PixelSurface& pixel) const {
    Light light;
    const auto size = static_cast<float>(block);
    const float u = (static_cast<float>(x) + 0.5F) / size - 0.5F;
    const float v = (static_cast<float>(y) + 0.5F) / size - 0.5F;
    const int bx = static_cast<int>(std::floor(u));
    const int by = static_cast<int>(std::floor(v));
    const float fx = u - static_cast<float>(bx);
    const float fy = v - static_cast<float>(by);
    for (int k = 0; k < 4; ++k) {
      const float tent = ((k & 1) != 0 ? fx : 1.0F - fx) * ((k & 2) != 0 ? fy : 1.0F - fy);
      const int px = (bx + (k & 1)) * block + block / 2;
      const int py = (by + (k >> 1)) * block + block / 2;
      if (tent > 0 && px >= 0 && py >= 0 && px < map_.width_px && py < map_.height_px) {
        visit(px, py, tent, pixel, true, light);
      }
    }
    return light;
  }

  // Seven by seven blocks about the pixel's own, near ones first in weight.
  [[nodiscard]] Light square(int x, int y, int block, const PixelSurface& pixel, bool alike) const {
    constexpr int kRadius = 3;
    Light light;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        const int px = x + dx * block;
        const int py = y + dy * block;
        if (px >= 0 && py >= 0 && px < map_.width_px && py < map_.height_px) {
          visit(px, py, 1.0F / static_cast<float>(1 + dx * dx + dy * dy), pixel, alike, light);
        }
      }
    }
    return light;
  }

  const SamplingMap& map_;
  const Guides& guides_;
  const SurfaceCells& lattice_;
  const SmoothingSettings& settings_;
};

// Guides of a miss or an unlit surface say all there is to know.
bool only_shines(SurfaceKind kind) {
  return kind == SurfaceKind::miss || kind == SurfaceKind::unlit;
}

struct PixelValue {
  Vec3f radiance;
  float variance = 0;
};

// Of a surface that reflects. `unknown`: says what is there instead where no sample is near.
template <class Unknown>
PixelValue shade(const Light& light, const Vec3f& albedo, const Vec3f& emission, const Unknown& unknown) {
  if (!(light.weight > 0)) {
    const SiteValue value = unknown();
    return {value.radiance, value.variance};
  }
  const float least = kLeastAlbedo * light.weight;
  const float scale = luminance(albedo) / light.weight;
  return {emission + Vec3f{albedo.x * light.reflected.x / std::max(light.albedo.x, least),
                           albedo.y * light.reflected.y / std::max(light.albedo.y, least),
                           albedo.z * light.reflected.z / std::max(light.albedo.z, least)},
          scale * scale * light.variance};
}

// The pixels of a region between four blocks of its own size: [x, x_end) x [y, y_end), cut by the frame.
struct Square {
  int column, row;  // the upper left of the blocks
  int x, y, x_end, y_end;
};

// Fills the pixels of one region that need filtering, square by square.
class SquareFiller {
 public:
  SquareFiller(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings,
               const Gather& gather, std::size_t region, Frame& frame)
      : input_(input),
        map_(input.map),
        guides_(*input.guides),
        lattice_(lattice),
        settings_(settings),
        gather_(gather),
        region_(region),
        block_(input.map.regions[region].block_px),
        frame_(frame) {}

  void fill(const Square& square) {
    for (int y = square.y; y < square.y_end; ++y) {
      for (int x = square.x; x < square.x_end; ++x) {
        if (map_.region(x, y) == region_ &&
            (block_ > 1 || needs_filtering(map_, map_.sites[lattice_.site_of_pixel(x, y)]))) {
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
    const std::size_t p = frame_.radiance.index(x, y);
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
      const int px = (square.column + (k & 1)) * block_ + block_ / 2;
      const int py = (square.row + (k >> 1)) * block_ + block_ / 2;
      if (px < 0 || py < 0 || px >= map_.width_px || py >= map_.height_px) {
        continue;
      }
      const std::uint32_t site = lattice_.site_of_pixel(px, py);
      for (std::size_t c = lattice_.first[site]; c < lattice_.first[site + 1]; ++c) {
        add_cell(lattice_.cells[c], static_cast<std::size_t>(k), pixels_, settings_, sums);
      }
    }
    divide_light(sums);
    for (std::size_t i = 0; i < pixels_.count; ++i) {
      store(at_[i].x, at_[i].y, sums, i);
    }
    pixels_.count = 0;
  }

  void store(int x, int y, const LightLanes& sums, std::size_t i) {
    const std::size_t p = frame_.radiance.index(x, y);
    const Vec3f& albedo = guides_.albedo.pixels[p];
    PixelValue value{guides_.emission.pixels[p]};
    const bool shaded = !only_shines(guides_.kind.pixels[p]);
    if (shaded && enough(sums.weight[i], sums.all[i])) {
      value.radiance += albedo * Vec3f{sums.reflected_r[i], sums.reflected_g[i], sums.reflected_b[i]};
      const float shade_of = luminance(albedo);
      value.variance = shade_of * shade_of * sums.variance[i];
    } else if (shaded) {
      value = shade(gather_.farther(x, y, block_, gather_.surface_of(x, y)), albedo, value.radiance,
                    [&] { return input_.values.value(lattice_.site_of_pixel(x, y)); });
    }
    frame_.radiance.pixels[p] = value.radiance;
    frame_.variance.pixels[p] = value.variance;
  }

  const FilterInput& input_;
  const SamplingMap& map_;
  const Guides& guides_;
  const SurfaceCells& lattice_;
  const SmoothingSettings& settings_;
  const Gather& gather_;
  std::size_t region_;
  int block_;
  Frame& frame_;
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

std::vector<SquareRow> rows_of_squares(const SamplingMap& map) {
  struct Bounds {
    int x0 = std::numeric_limits<int>::max(), y0 = std::numeric_limits<int>::max(), x1 = -1, y1 = -1;
  };
  std::vector<Bounds> bounds(map.regions.size());
  for (const Site& site : map.sites) {
    Bounds& b = bounds[site.region];
    b.x0 = std::min<int>(b.x0, site.block_x);
    b.y0 = std::min<int>(b.y0, site.block_y);
    b.x1 = std::max<int>(b.x1, site.block_x);
    b.y1 = std::max<int>(b.y1, site.block_y);
  }
  std::vector<SquareRow> rows;
  for (std::size_t r = 0; r < bounds.size(); ++r) {
    // A block's pixels lie in the squares before and after its middle.
    const int before = map.regions[r].block_px > 1 ? 1 : 0;
    for (int row = bounds[r].y0 - before; row <= bounds[r].y1; ++row) {
      rows.push_back({r, row, bounds[r].x0 - before, bounds[r].x1 + 1});
    }
  }
  return rows;
}

void fill_squares(const FilterInput& input, const SurfaceCells& lattice, const SmoothingSettings& settings,
                  const Gather& gather, Frame& frame) {
  const SamplingMap& map = input.map;
  const std::vector<SquareRow> rows = rows_of_squares(map);
  parallel_for(rows.size(), input.threads, [&](std::size_t k) {
    const SquareRow& row = rows[k];
    const int block = map.regions[row.region].block_px;
    const auto begin = [&](int at) { return at * block + block / 2; };
    SquareFiller filler(input, lattice, settings, gather, row.region, frame);
    for (int column = row.first_column; column < row.end_column; ++column) {
      filler.fill({column, row.row, std::max(begin(column), 0), std::max(begin(row.row), 0),
                   std::min(begin(column + 1), map.width_px), std::min(begin(row.row + 1), map.height_px)});
    }
  });
}

// Pixels that edges cross are the mean of all their rays. Before any is changed, all are computed.
void blend_edges(const FilterInput& input, const Gather& gather, const Image<std::uint32_t>& site_of_pixel,
                 Frame& frame) {
  const Guides& guides = *input.guides;
  const std::vector<EdgeRay>& rays = guides.edge_rays;
  constexpr std::size_t kRaysPerTask = 4096;
  struct Blended {
    std::uint32_t pixel;
    PixelValue value;
  };
  std::vector<std::vector<Blended>> blended((rays.size() + kRaysPerTask - 1) / kRaysPerTask);
  const auto value_of = [&](const EdgeRay& ray) -> PixelValue {
    if (!ray.own_surface) {
      return {frame.radiance.pixels[ray.seen_by], frame.variance.pixels[ray.seen_by]};
    }
    const EdgeSurface& surface = guides.edge_surfaces[ray.seen_by];
    if (only_shines(surface.kind)) {
      return {surface.emission};
    }
    const std::uint32_t site = site_of_pixel.pixels[ray.pixel];
    const int x = static_cast<int>(ray.pixel) % input.map.width_px;
    const int y = static_cast<int>(ray.pixel) / input.map.width_px;
    const int block = input.map.regions[input.map.sites[site].region].block_px;
    return shade(gather.light_at(x, y, block, gather.surface_of(surface)), surface.albedo, surface.emission,
                 [&] { return input.values.value(site); });
  };
  parallel_for(blended.size(), input.threads, [&](std::size_t task) {
    // A pixel belongs to the task in which its first ray is.
    std::size_t k = task * kRaysPerTask;
    while (k > 0 && k < rays.size() && rays[k].pixel == rays[k - 1].pixel) {
      ++k;
    }
    while (k < std::min((task + 1) * kRaysPerTask, rays.size())) {
      const std::uint32_t pixel = rays[k].pixel;
      const bool changed = needs_filtering(input.map, input.map.sites[site_of_pixel.pixels[pixel]]);
      PixelValue sum{frame.radiance.pixels[pixel], frame.variance.pixels[pixel]};
      float count = 1;
      for (; k < rays.size() && rays[k].pixel == pixel; ++k) {
        if (changed) {
          const PixelValue value = value_of(rays[k]);
          sum.radiance += value.radiance;
          sum.variance += value.variance;
          ++count;
        }
      }
      if (changed) {
        // Variance at most: they may share their samples.
        blended[task].push_back({pixel, {sum.radiance / count, sum.variance / count}});
      }
    }
  });
  parallel_for(blended.size(), input.threads, [&](std::size_t task) {
    for (const Blended& b : blended[task]) {
      frame.radiance.pixels[b.pixel] = b.value.radiance;
      frame.variance.pixels[b.pixel] = b.value.variance;
    }
  });
}

}  // namespace

Frame filter_guided(const FilterInput& input) {
  return frame_from_surfaces(input, smooth_surfaces);
}

Frame frame_from_surfaces(const FilterInput& input, SmoothSurfaces smooth) {
  const SamplingMap& map = input.map;
  const SmoothingSettings settings;
  SurfaceCells lattice = make_surface_cells(input.sparse, map, input.guides->camera, input.threads);
  smooth(lattice, map, settings, input.threads);

  // AOVs are those of the linear filter.
  Frame frame = input.values.has_guides() ? filter_linear(input) : make_frame(map, false);
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      if (!needs_filtering(map, site)) {
        paint_site(frame, map, input.values, i);
        continue;
      }
      const float density = static_cast<float>(input.values.count(i)) / static_cast<float>(site.pixels);
      for_each_pixel(map, site, [&](int x, int y) { frame.sample_count(x, y) = density; });
    }
  });
  const Gather gather(input, lattice, settings);
  fill_squares(input, lattice, settings, gather, frame);
  blend_edges(input, gather, lattice.site_of_pixel, frame);
  return frame;
}

}  // namespace gazetrace
