// SPDX-License-Identifier: Apache-2.0
// Intel Open Image Denoise instead of the smoothing of "guided". The network expects noise that is independent from
// pixel to pixel. So it is shown the light on surfaces without their texture (surface_cells.hpp), one pixel per block,
// in one picture for each size of blocks. Blocks across an edge, with light of several surfaces, are smoothed as in
// "guided". The filter is built only where the library is found.
#include "reconstruct/filter.hpp"

#ifdef GAZETRACE_WITH_OIDN

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.hpp"
#include "reconstruct/open_image_denoise.hpp"
#include "reconstruct/surface_frame.hpp"

namespace gazetrace {
namespace {

// A block with more than this share of its samples on one surface shows the light of that surface.
constexpr float kOneSurface = 0.9F;

const SurfaceCell* main_surface(const SurfaceCells& cells, std::size_t site) {
  const SurfaceCell* most = nullptr;
  float samples = 0;
  for (std::size_t k = cells.first[site]; k < cells.first[site + 1]; ++k) {
    const SurfaceCell& cell = cells.cells[k];
    samples += cell.samples;
    if (most == nullptr || cell.samples > most->samples) {
      most = &cell;
    }
  }
  return most != nullptr && most->samples > kOneSurface * samples ? most : nullptr;
}

// The light on everything that a site's samples hit.
struct SiteLight {
  Vec3f light, normal;
  bool is_surface = false;
};

SiteLight light_of(const SurfaceCells& cells, std::size_t site) {
  Vec3f reflected;
  Vec3f albedo;
  Vec3f normal;
  float samples = 0;
  for (std::size_t k = cells.first[site]; k < cells.first[site + 1]; ++k) {
    const SurfaceCell& cell = cells.cells[k];
    reflected += cell.samples * cell.reflected;
    albedo += cell.samples * cell.albedo;
    normal += cell.samples * cell.normal;
    samples += cell.samples;
  }
  if (!(samples > 0)) {
    return {};
  }
  const float least = kLeastAlbedo * samples;
  const float length = std::sqrt(dot(normal, normal));
  return {{reflected.x / std::max(albedo.x, least), reflected.y / std::max(albedo.y, least),
           reflected.z / std::max(albedo.z, least)},
          length > 0 ? normal * (1.0F / length) : normal,
          true};
}

// One pixel per block of a region's size, over the whole frame. Where other regions are, it shows the site in the
// block's middle, and of it what is smoothed already: the noise of one coarse block over many pixels would look like a
// detail.
struct BlockPicture {
  BlockPicture(const SurfaceCells& traced, const SurfaceCells& smooth, const SamplingMap& map, std::size_t region,
               int block_px)
      : width((map.width_px + block_px - 1) / block_px),
        height((map.height_px + block_px - 1) / block_px),
        light(width, height),
        white(width, height),
        normal(width, height),
        site(width, height) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        site(x, y) = traced.site_of_pixel(std::min(x * block_px + block_px / 2, map.width_px - 1),
                                          std::min(y * block_px + block_px / 2, map.height_px - 1));
        const SiteLight seen = light_of(map.sites[site(x, y)].region == region ? traced : smooth, site(x, y));
        light(x, y) = seen.light;
        normal(x, y) = seen.normal;
        white(x, y) = seen.is_surface ? Vec3f{1, 1, 1} : Vec3f{};
      }
    }
  }

  int width, height;
  ImageRgb light, white, normal;  // white: the albedo of what has no texture; 0 where nothing reflects
  Image<std::uint32_t> site;
};

void denoise_surfaces(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads) {
  const SurfaceCells traced = cells;
  smooth_surfaces(cells, map, settings, threads);
  std::vector<bool> has_light(map.regions.size());
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    has_light[map.sites[i].region] = has_light[map.sites[i].region] || cells.first[i] != cells.first[i + 1];
  }
  for (std::size_t region = 0; region < map.regions.size(); ++region) {
    if (!has_light[region]) {
      continue;
    }
    const BlockPicture blocks(traced, cells, map, region, map.regions[region].block_px);
    const ImageRgb smooth = open_image_denoise(blocks.light, blocks.white, blocks.normal, threads);
    parallel_for(static_cast<std::size_t>(blocks.height), threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < blocks.width; ++x) {
        const std::uint32_t site = blocks.site(x, y);
        const SurfaceCell* from = map.sites[site].region == region ? main_surface(traced, site) : nullptr;
        if (from != nullptr) {
          SurfaceCell& cell = cells.cells[static_cast<std::size_t>(from - traced.cells.data())];
          const Vec3f light = smooth(x, y);
          cell.albedo = from->albedo;
          cell.reflected = {light.x * cell.albedo.x, light.y * cell.albedo.y, light.z * cell.albedo.z};
        }
      }
    });
  }
}

}  // namespace

const FilterDefinition filter_oidn{.needs = kSurfaceNeeds, .frame = [](const FilterInput& input) {
                                     return frame_from_surfaces(input, denoise_surfaces);
                                   }};

}  // namespace gazetrace

#endif
