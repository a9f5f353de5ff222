// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/keep_residuals.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/region_residuals.hpp"

namespace gazetrace {
namespace {

std::vector<SiteResidual> residuals_of_sites(const FilterInput& input, const SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  std::vector<SiteResidual> residuals(map.sites.size());
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (input.values.count(i) == 0) {
        continue;
      }
      Vec3f mean;
      float replica = 0;
      for_each_pixel(map, map.sites[i], [&](int x, int y) {
        const std::size_t p = picture.radiance.index(x, y);
        mean += picture.radiance.pixels[p];
        replica += picture.replica.pixels[p];
      });
      const float share = 1.0F / static_cast<float>(map.sites[i].pixels);
      SiteResidual& residual = residuals[i];
      residual.radiance = input.values.value(i).radiance - share * mean;
      residual.shown = share * mean;
      // Halves that are equal to the bit say nothing: one of them had no sample that is a number.
      if (input.values.count(i) > 1 && input.sparse.half_difference[i] != 0) {
        residual.replica = input.sparse.half_difference[i] - share * replica;
      } else {
        residual.replica = replica_of_single_sample(i, residual.radiance);
      }
    }
  });
  return residuals;
}

}  // namespace

float replica_of_single_sample(std::size_t site, const Vec3f& residual) {
  const float sign = (hash32(static_cast<std::uint32_t>(site) ^ 0x5bd1e995U) & 1U) != 0 ? 1.0F : -1.0F;
  return sign * luminance(residual);
}

void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, SurfacePicture& picture) {
  keep_residuals(input, settings, site_of_pixel, residuals_of_sites(input, picture), true, picture);
}

void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, const std::vector<SiteResidual>& residuals,
                    bool of_light, SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  std::vector<RegionResiduals> of_region;
  of_region.reserve(map.regions.size());
  for (const BlockWindow& window : windows_of_regions(map)) {
    of_region.emplace_back(input, settings, window, residuals, site_of_pixel, picture);
  }
  for_each_row(map.height_px, input.threads, [&](int y) {
    std::vector<RowOfResiduals> rows;
    for (std::size_t r = 0; r < of_region.size(); ++r) {
      rows.emplace_back(of_region[r], map.regions[r].block_px, y);
    }
    for (int x = 0; x < map.width_px; ++x) {
      const std::uint8_t region = map.region(x, y);
      const std::size_t i = picture.radiance.index(x, y);
      Vec3f& radiance = picture.radiance.pixels[i];
      const KeptResidual kept = rows[region].at(x, luminance(radiance));
      const Vec3f value = radiance + kept.radiance;
      radiance = {std::max(value.x, 0.0F), std::max(value.y, 0.0F), std::max(value.z, 0.0F)};
      picture.replica.pixels[i] += kept.replica;
      if (of_light) {
        const float rest = kept.rest * kept.rest;
        picture.variance.pixels[i] = rest * picture.variance.pixels[i] + kept.variance;
        picture.error.pixels[i] = rest * picture.error.pixels[i] + kept.error;
      } else {
        picture.first_hits_variance.pixels[i] = kept.variance;
        picture.first_hits_error.pixels[i] = kept.error;
      }
    }
  });
}

}  // namespace gazetrace
