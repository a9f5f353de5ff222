// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/denoiser_input.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/filter.hpp"
#include "reconstruct/surface_cells.hpp"
#include "reconstruct/surface_lookup.hpp"
#include "reconstruct/surface_smoothing.hpp"

namespace gazetrace {
namespace {

// The guides count less and less where hits are shifted by more than half a pixel (root mean square), and nothing from
// one pixel on.
constexpr float kLeastShiftPx = 0.5F;
constexpr float kFullShiftPx = 1;
// With so many pixels of samples' own features alone, which are noisy, the denoiser is not told that they are clean.
constexpr double kMostShifted = 0.5;

// What a pixel's rays or a site's samples saw, on average; a miss counts as zero.
struct Features {
  Vec3f albedo, normal;
};

// How far the guides are to be believed: 1 where samples go where they do.
float share_of_guides(const SparseFrame& sparse, std::size_t site) {
  const auto samples = static_cast<float>(sparse.count[site]);
  if (sparse.count[site] == 0) {
    return 1;
  }
  const float shift_px = std::sqrt(sparse.first_hits[site].square_shift_px2 / samples);
  return std::clamp((kFullShiftPx - shift_px) / (kFullShiftPx - kLeastShiftPx), 0.0F, 1.0F);
}

Features seen_by_samples(const SparseFrame& sparse, std::size_t site) {
  Features seen;
  for (std::size_t s = sparse.first_surface[site]; s < sparse.first_surface[site + 1]; ++s) {
    seen.albedo += sparse.surfaces[s].albedo;
    seen.normal += sparse.surfaces[s].normal;
  }
  const float share = 1.0F / static_cast<float>(std::max(sparse.count[site], 1U));
  return {share * seen.albedo, share * seen.normal};
}

Features seen_by_guides(const Guides& guides, std::size_t pixel) {
  return only_shines(guides.kind.pixels[pixel]) ? Features{}
                                                : Features{guides.albedo.pixels[pixel], guides.normal.pixels[pixel]};
}

// Of a half without samples: that of all.
Vec3f mean_of_half(const SparseFrame& sparse, std::size_t site, std::size_t half, const Vec3f& mean) {
  const HalfSum& first = sparse.first_half[site];
  const std::uint32_t count = half == 0 ? first.count : sparse.count[site] - first.count;
  const Vec3f sum = half == 0 ? first.radiance : sparse.sum[site] - first.radiance;
  return count == 0 ? mean : sum / static_cast<float>(count);
}

// What a share of a site's radiance gives to a pixel that has `here` of what the site's pixels have in the mean.
Vec3f share_of(const Vec3f& radiance, const Vec3f& here, const Vec3f& mean) {
  constexpr float kLeast = 1e-4F;  // where the guides see nothing that the samples do, all pixels have the same
  return {radiance.x * (here.x + kLeast) / (mean.x + kLeast), radiance.y * (here.y + kLeast) / (mean.y + kLeast),
          radiance.z * (here.z + kLeast) / (mean.z + kLeast)};
}

// One light for all pixels of a site, times the albedo of each, and what each sees shine: their mean is `radiance`.
void spread_over_pixels(const SamplingMap& map, const Site& site, const Vec3f& radiance, const Vec3f& shone,
                        const ImageRgb& emission, DenoiserInput& out) {
  Vec3f albedo;
  Vec3f shining;
  for_each_pixel(map, site, [&](int x, int y) {
    albedo += out.albedo(x, y);
    shining += emission(x, y);
  });
  const auto pixels = static_cast<float>(site.pixels);
  for_each_pixel(map, site, [&](int x, int y) {
    out.radiance(x, y) = share_of(radiance - shone, out.albedo(x, y), albedo / pixels) +
                         share_of(shone, emission(x, y), shining / pixels);
  });
}

// Light for sites without samples of their own: that of the surfaces around, smoothed as far as it is noise.
class LightAround {
 public:
  explicit LightAround(const FilterInput& input) : input_(input) {
    cells_ = make_surface_cells(input.sparse, input.map, input.guides->camera, input.threads);
    smooth_surfaces(cells_, input.map, settings_, input.threads);
    lookup_.emplace(input, cells_, settings_);
  }

  [[nodiscard]] Vec3f radiance(int x, int y, std::size_t site) const {
    const Guides& guides = *input_.guides;
    if (only_shines(guides.kind(x, y))) {
      return guides.emission(x, y);
    }
    return shaded(lookup_->light_at(x, y, lookup_->surface_of(x, y)), guides.albedo(x, y), guides.emission(x, y),
                  [&] { return input_.values.value(site); })
        .radiance;
  }

 private:
  const FilterInput& input_;
  SmoothingSettings settings_;
  SurfaceCells cells_;
  std::optional<SurfaceLookup> lookup_;
};

}  // namespace

DenoiserInput denoiser_input(const SparseFrame& sparse, const SamplingMap& map, const Guides& guides, int threads) {
  const SiteValues values(sparse, map, threads);
  const FilterInput input{sparse, values, map, &guides, threads};
  std::optional<LightAround> around;
  const bool has_empty = std::find(sparse.count.begin(), sparse.count.end(), 0U) != sparse.count.end();
  if (has_empty) {
    around.emplace(input);
  }
  DenoiserInput out;
  out.radiance = ImageRgb(map.width_px, map.height_px);
  out.albedo = out.radiance;
  out.normal = out.radiance;
  out.samples = ImageGray(map.width_px, map.height_px);
  const auto is_several = [](std::uint32_t count) { return count > 1; };
  const bool has_halves =
      !sparse.first_half.empty() && std::any_of(sparse.count.begin(), sparse.count.end(), is_several);
  if (has_halves) {
    out.halves = {out.radiance, out.radiance};
  }
  std::atomic<std::size_t> shifted = 0;
  parallel_for(map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      const Features own = seen_by_samples(sparse, i);
      const float share = share_of_guides(sparse, i);
      const float rays = share * static_cast<float>(guides.spp);
      // Samples of a larger site are not those of its pixels, and only where the guides know nothing better than them.
      const float samples = site.pixels == 1 ? static_cast<float>(sparse.count[i]) : 1.0F - share;
      const bool by_samples = sparse.count[i] > 0;
      for_each_pixel(map, site, [&](int x, int y) {
        const std::size_t p = out.radiance.index(x, y);
        const Features by_guides = seen_by_guides(guides, p);
        const float all = std::max(rays + samples, 1e-6F);
        const Vec3f albedo = (rays * by_guides.albedo + samples * own.albedo) / all;
        out.albedo.pixels[p] = {std::clamp(albedo.x, 0.0F, 1.0F), std::clamp(albedo.y, 0.0F, 1.0F),
                                std::clamp(albedo.z, 0.0F, 1.0F)};
        out.normal.pixels[p] = (rays * by_guides.normal + samples * own.normal) / all;
        out.samples.pixels[p] = static_cast<float>(sparse.count[i]) / static_cast<float>(site.pixels);
        if (!by_samples) {
          out.radiance.pixels[p] = around->radiance(x, y, i);
        } else if (site.pixels == 1) {
          out.radiance.pixels[p] = values.value(i).radiance;
        }
        for (std::size_t half = 0; has_halves && half < 2; ++half) {
          out.halves[half].pixels[p] =
              by_samples ? mean_of_half(sparse, i, half, values.value(i).radiance) : out.radiance.pixels[p];
        }
      });
      if (by_samples && site.pixels > 1) {
        spread_over_pixels(map, site, values.value(i).radiance,
                           sparse.first_hits[i].shone / static_cast<float>(sparse.count[i]), guides.emission, out);
      }
      shifted += share < 0.5F ? static_cast<std::size_t>(site.pixels) : 0;
    }
  });
  out.clean = static_cast<double>(shifted) < kMostShifted * static_cast<double>(out.radiance.pixels.size());
  return out;
}

}  // namespace gazetrace
