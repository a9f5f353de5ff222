// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/surface_smoothing.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr std::array<float, 2> kBinomial{0.5F, 0.25F};  // 1 2 1 in x and y, half

class Smoother {
 public:
  Smoother(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads)
      : lattice_(cells), map_(map), settings_(settings), threads_(threads) {}

  // Noise from the spread of all samples of the nearest blocks: a site's own few say little about it.
  void estimate_variance() {
    std::vector<float> variance(lattice_.cells.size());
    for_each_cell([&](std::size_t site, std::size_t i) {
      const SurfaceCell& own = lattice_.cells[i];
      double weight = 0;
      double light = 0;
      double square = 0;
      for_each_neighbor(site, 1, 1, [&](const SurfaceCell& other, int, int) {
        const double w = static_cast<double>(likeness(own, other) * other.samples);
        weight += w;
        light += w * static_cast<double>(other.light);
        square += w * static_cast<double>(other.square);
      });
      const double mean = weight > 0 ? light / weight : 0;
      const double spread = weight > 0 ? std::max(square / weight - mean * mean, 0.0) : 0;
      variance[i] = static_cast<float>(spread) / own.samples;
    });
    for (std::size_t i = 0; i < variance.size(); ++i) {
      lattice_.cells[i].variance = variance[i];
    }
  }

  void level(int step) {
    std::vector<SurfaceCell> out = lattice_.cells;
    for_each_cell([&](std::size_t site, std::size_t i) {
      const SurfaceCell& own = lattice_.cells[i];
      Vec3f reflected;
      Vec3f albedo;
      float variance = 0;
      float weight = 0;
      for_each_neighbor(site, step, 1, [&](const SurfaceCell& other, int dx, int dy) {
        float w = kBinomial[static_cast<std::size_t>(std::abs(dx))] *
                  kBinomial[static_cast<std::size_t>(std::abs(dy))] * other.samples;
        if (&other != &own) {
          w *= likeness(own, other);
          if (w <= 0) {
            return;
          }
          // Of the difference, so that both sides judge alike: were each to go by its own noise alone, quiet places
          // would refuse what loud ones have to give, and light would be lost.
          const float noise =
              settings_.light_sigmas * std::sqrt(own.variance + other.variance) + 1e-6F * std::fabs(own.light) + 1e-30F;
          w *= falling(std::fabs(other.light - own.light) / noise);
        }
        weight += w;
        reflected += w * other.reflected;
        albedo += w * other.albedo;
        variance += w * w * other.variance;
      });
      if (weight > 0) {
        SurfaceCell& smooth = out[i];
        smooth.reflected = reflected * (1.0F / weight);
        smooth.albedo = albedo * (1.0F / weight);
        smooth.variance = variance / (weight * weight);
        smooth.light = luminance(smooth.reflected) / std::max(luminance(smooth.albedo), kLeastAlbedo);
      }
    });
    lattice_.cells.swap(out);
  }

 private:
  [[nodiscard]] float likeness(const SurfaceCell& a, const SurfaceCell& b) const {
    if (a.kind != b.kind) {
      return 0;
    }
    return surface_likeness(a.normal, a.place_m, b.normal, b.place_m, 0.5F * std::min(a.footprint_m, b.footprint_m),
                            settings_);
  }

  template <class Visit>
  void for_each_cell(const Visit& visit) const {
    parallel_for(map_.tiles.size(), threads_, [&](std::size_t t) {
      const MapTile& tile = map_.tiles[t];
      for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
        for (std::size_t i = lattice_.first[site]; i < lattice_.first[site + 1]; ++i) {
          visit(site, i);
        }
      }
    });
  }

  // The surfaces of the sites that lie `step` blocks apart, in a square of 2 radius + 1.
  template <class Visit>
  void for_each_neighbor(std::size_t site, int step, int radius, const Visit& visit) const {
    const int block = map_.regions[map_.sites[site].region].block_px;
    const int x = map_.sites[site].block_x * block + block / 2;
    const int y = map_.sites[site].block_y * block + block / 2;
    for (int dy = -radius; dy <= radius; ++dy) {
      const int py = y + dy * step * block;
      if (py < 0 || py >= map_.height_px) {
        continue;
      }
      for (int dx = -radius; dx <= radius; ++dx) {
        const int px = x + dx * step * block;
        if (px < 0 || px >= map_.width_px) {
          continue;
        }
        // A block may be cut by a border between regions: its own site is this one, whatever pixel is in the middle.
        const std::size_t other = dx == 0 && dy == 0 ? site : lattice_.site_of_pixel(px, py);
        for (std::size_t k = lattice_.first[other]; k < lattice_.first[other + 1]; ++k) {
          visit(lattice_.cells[k], dx, dy);
        }
      }
    }
  }

  SurfaceCells& lattice_;
  const SamplingMap& map_;
  const SmoothingSettings& settings_;
  int threads_;
};

}  // namespace

void smooth_surfaces(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings, int threads) {
  Smoother smoother(cells, map, settings, threads);
  smoother.estimate_variance();
  for (int level = 0; level < settings.levels; ++level) {
    smoother.level(1 << level);
  }
}

}  // namespace gazetrace
