// SPDX-License-Identifier: Apache-2.0
// Light apart from texture: samples carry reflected radiance over the albedo of what they hit (surface_cells.hpp),
// which is smoothed along surfaces (surface_smoothing.hpp). Each pixel takes it from the surfaces of the nearest blocks
// that are like the one it sees, multiplies it by its own albedo and adds what it sees shining:
//   radiance(p) = emission(p) + albedo(p) * sum_c w(p, c) reflected(c) / sum_c w(p, c) albedo(c)
// Emission, misses and texture thus come from the first hits at full resolution, and no edge of theirs is smoothed.
// Sites that needs_filtering leaves out keep their own mean, bit by bit.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/filter.hpp"
#include "reconstruct/surface_cells.hpp"
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
    Light light = nearest_four(x, y, block, pixel);
    if (light.weight > kEnoughLike * light.all && light.weight > 0) {
      return light;
    }
    light = square(x, y, block, pixel, true);
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
  [[nodiscard]] PixelSurface surface_of(const EdgeRay& ray) const {
    return {ray.normal, guides_.camera.place(ray.x, ray.y, ray.depth_m), ray.kind};
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

// What one ray sees. `unknown`: for a surface that no sample is near to.
PixelValue shade(const Gather& gather, int x, int y, int block, const PixelSurface& surface, const Vec3f& albedo,
                 const Vec3f& emission, const SiteValue& unknown) {
  if (only_shines(surface.kind)) {
    return {emission};
  }
  const Light light = gather.light_at(x, y, block, surface);
  if (!(light.weight > 0)) {
    return {unknown.radiance, unknown.variance};
  }
  const float least = kLeastAlbedo * light.weight;
  const float scale = luminance(albedo) / light.weight;
  return {emission + Vec3f{albedo.x * light.reflected.x / std::max(light.albedo.x, least),
                           albedo.y * light.reflected.y / std::max(light.albedo.y, least),
                           albedo.z * light.reflected.z / std::max(light.albedo.z, least)},
          scale * scale * light.variance};
}

// Pixels that edges cross are the mean of all their rays.
void blend_edges(const FilterInput& input, const Gather& gather, const Image<std::uint32_t>& site_of_pixel,
                 Frame& frame) {
  const std::vector<EdgeRay>& rays = input.guides->edge_rays;
  constexpr std::size_t kRaysPerTask = 4096;
  parallel_for((rays.size() + kRaysPerTask - 1) / kRaysPerTask, input.threads, [&](std::size_t task) {
    // A pixel belongs to the task in which its first ray is.
    std::size_t k = task * kRaysPerTask;
    while (k > 0 && k < rays.size() && rays[k].pixel == rays[k - 1].pixel) {
      ++k;
    }
    while (k < std::min((task + 1) * kRaysPerTask, rays.size())) {
      const std::uint32_t pixel = rays[k].pixel;
      const std::uint32_t index = site_of_pixel.pixels[pixel];
      const Site& site = input.map.sites[index];
      const bool changed = needs_filtering(input.map, site);
      const int x = static_cast<int>(pixel) % input.map.width_px;
      const int y = static_cast<int>(pixel) / input.map.width_px;
      const int block = input.map.regions[site.region].block_px;
      PixelValue sum{frame.radiance.pixels[pixel], frame.variance.pixels[pixel]};
      float count = 1;
      for (; k < rays.size() && rays[k].pixel == pixel; ++k) {
        if (changed) {
          const PixelValue value = shade(gather, x, y, block, gather.surface_of(rays[k]), rays[k].albedo,
                                         rays[k].emission, input.values.value(index));
          sum.radiance += value.radiance;
          sum.variance += value.variance;
          ++count;
        }
      }
      if (changed) {
        frame.radiance.pixels[pixel] = sum.radiance / count;
        frame.variance.pixels[pixel] = sum.variance / count;  // at most: they may share their samples
      }
    }
  });
}

}  // namespace

Frame filter_guided(const FilterInput& input) {
  const SamplingMap& map = input.map;
  const Guides& guides = *input.guides;
  const SmoothingSettings settings;
  SurfaceCells lattice = make_surface_cells(input.sparse, map, guides.camera, input.threads);
  smooth_surfaces(lattice, map, settings, input.threads);

  // AOVs are those of the linear filter.
  Frame frame = input.values.has_guides() ? filter_linear(input) : make_frame(map, false);
  const Gather gather(input, lattice, settings);
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      if (!needs_filtering(map, site)) {
        paint_site(frame, map, input.values, i);
        continue;
      }
      const int block = map.regions[site.region].block_px;
      const float density = static_cast<float>(input.values.count(i)) / static_cast<float>(site.pixels);
      const SiteValue unknown = input.values.value(i);
      for_each_pixel(map, site, [&](int x, int y) {
        const std::size_t p = frame.radiance.index(x, y);
        const PixelValue value = shade(gather, x, y, block, gather.surface_of(x, y), guides.albedo.pixels[p],
                                       guides.emission.pixels[p], unknown);
        frame.radiance.pixels[p] = value.radiance;
        frame.variance.pixels[p] = value.variance;
        frame.sample_count.pixels[p] = density;
      });
    }
  });
  blend_edges(input, gather, lattice.site_of_pixel, frame);
  return frame;
}

}  // namespace gazetrace
