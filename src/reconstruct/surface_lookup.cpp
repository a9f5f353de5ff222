// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_lookup.hpp"

#include <cmath>

namespace gazetrace {

GatheredLight SurfaceLookup::light_at(int x, int y, const PixelSurface& pixel) const {
  const GatheredLight light = nearest_four(x, y, pixel);
  return enough_alike(light.weight, light.all) ? light : farther(x, y, pixel);
}

GatheredLight SurfaceLookup::farther(int x, int y, const PixelSurface& pixel) const {
  const GatheredLight light = square(x, y, pixel, true);
  return light.weight > 0 ? light : square(x, y, pixel, false);
}

PixelSurface SurfaceLookup::surface_of(int x, int y) const {
  const float half_width = 0.5F * static_cast<float>(map_.width_px);
  const float half_height = 0.5F * static_cast<float>(map_.height_px);
  return {guides_.normal(x, y),
          guides_.camera.place(static_cast<float>(x) + 0.5F - half_width, static_cast<float>(y) + 0.5F - half_height,
                               guides_.depth_m(x, y)),
          guides_.kind(x, y)};
}

PixelSurface SurfaceLookup::surface_of(const EdgeSurface& seen) const {
  return {seen.normal, guides_.camera.place(seen.x, seen.y, seen.depth_m), seen.kind};
}

void SurfaceLookup::add_block(std::size_t region, int bx, int by, float tent, const PixelSurface& pixel, bool alike,
                              GatheredLight& light) const {
  for_each_cell_of_block(lattice_, region, bx, by, [&](const SurfaceCell& cell) {
    const float w = tent * cell.samples;
    light.all += w;
    if (!alike) {
      light.add(w, cell);
    } else if (cell.kind == pixel.kind) {
      const float like =
          likeness(pixel.normal, cell.normal, cell.position_m - pixel.position_m, 0.5F * cell.footprint_m, settings_);
      if (like > 0) {
        light.add(w * like, cell);
      }
    }
  });
}

// Bilinear interpolation between blocks of the pixel's own size.
GatheredLight SurfaceLookup::nearest_four(int x, int y, const PixelSurface& pixel) const {
  GatheredLight light;
  const std::size_t region = map_.region(x, y);
  const auto size = static_cast<float>(map_.regions[region].block_px);
  const float u = (static_cast<float>(x) + 0.5F) / size - 0.5F;
  const float v = (static_cast<float>(y) + 0.5F) / size - 0.5F;
  const int bx = static_cast<int>(std::floor(u));
  const int by = static_cast<int>(std::floor(v));
  const float fx = u - static_cast<float>(bx);
  const float fy = v - static_cast<float>(by);
  for (int k = 0; k < 4; ++k) {
    const float tent = ((k & 1) != 0 ? fx : 1.0F - fx) * ((k & 2) != 0 ? fy : 1.0F - fy);
    if (tent > 0) {
      add_block(region, bx + (k & 1), by + (k >> 1), tent, pixel, true, light);
    }
  }
  return light;
}

// Seven by seven blocks around the pixel's own, weighted by nearness.
GatheredLight SurfaceLookup::square(int x, int y, const PixelSurface& pixel, bool alike) const {
  constexpr int kRadius = 3;
  static_assert(kRadius <= BlockCells::kReach);
  GatheredLight light;
  const std::size_t region = map_.region(x, y);
  const int block = map_.regions[region].block_px;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      add_block(region, x / block + dx, y / block + dy, 1.0F / static_cast<float>(1 + dx * dx + dy * dy), pixel, alike,
                light);
    }
  }
  return light;
}

}  // namespace gazetrace
