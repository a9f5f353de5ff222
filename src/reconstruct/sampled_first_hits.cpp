// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/sampled_first_hits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/keep_residuals.hpp"

namespace gazetrace {
namespace {

// Binomial weights by the distance in blocks: wide for what decides, narrow for what is shown.
constexpr std::array<float, 3> kWide{6.0F / 16, 4.0F / 16, 1.0F / 16};
constexpr std::array<float, 2> kNarrow{0.5F, 0.25F};
// The guides count alone where hits are shifted by less than the first of these shares of a block (root mean square),
// and nothing where they are by more than the second.
constexpr float kLeastShift = 0.5F;
constexpr float kFullShift = 1;
// From this share of samples on blended surfaces on, the guides count only as what they are there: so many samples more
// in each pixel, and these in their places, while those of a site are spread over all of its pixels.
constexpr float kFullyBlended = 0.125F;
constexpr float kRaysOfGuides = 2;

// Of a site, or of several in the proportions of their weights.
struct Seen {
  Vec3f radiance;
  float replica = 0;  // of the error of its luminance
  float share = 0;    // of the picture, the rest of which is that of the guides
};

class SampledFirstHits {
 public:
  SampledFirstHits(const FilterInput& input, const SurfaceCells& cells)
      : input_(input), map_(input.map), cells_(cells), seen_(map_.sites.size()), around_(map_.sites.size()) {
    for_each_site([&](std::size_t i) { seen_[i] = seen_at(i); });
    if (std::any_of(input.sparse.first_hits.begin(), input.sparse.first_hits.end(), is_unlike_a_pinhole)) {
      for_each_site([&](std::size_t i) { seen_[i].share = share_at(i); });
      for_each_site([&](std::size_t i) { around_[i] = mean_around(i); });
    }
  }

  // Whether there is anything to show().
  [[nodiscard]] bool any_takes_the_place() const {
    return std::any_of(seen_.begin(), seen_.end(), [](const Seen& seen) { return seen.share > 0; });
  }

  // Puts the means around into the picture, between the centres of blocks.
  void show(SurfacePicture& picture) const {
    parallel_for(static_cast<std::size_t>(map_.height_px), input_.threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < map_.width_px; ++x) {
        const Seen seen = between_blocks(x, y);
        if (seen.share > 0) {
          const std::size_t p = picture.radiance.index(x, y);
          const float rest = 1.0F - seen.share;
          picture.radiance.pixels[p] = rest * picture.radiance.pixels[p] + seen.radiance;
          picture.replica.pixels[p] = rest * picture.replica.pixels[p] + seen.replica;
        }
      }
    });
  }

  // What the picture lacks of what each site saw.
  [[nodiscard]] std::vector<SiteResidual> residuals(const SurfacePicture& picture) const {
    std::vector<SiteResidual> residuals(map_.sites.size());
    for_each_site([&](std::size_t i) {
      const Seen& seen = seen_[i];
      if (!is_known(i)) {
        return;
      }
      Vec3f mean;
      float replica = 0;
      for_each_pixel(map_, map_.sites[i], [&](int x, int y) {
        const std::size_t p = picture.radiance.index(x, y);
        mean += picture.radiance.pixels[p];
        replica += picture.replica.pixels[p];
      });
      const float part = 1.0F / static_cast<float>(map_.sites[i].pixels);
      SiteResidual& residual = residuals[i];
      residual.shown = part * mean;
      residual.radiance = seen.radiance - part * mean;
      // Halves that are equal to the bit say nothing: one of them may be empty.
      const bool has_halves = input_.values.count(i) > 1 && input_.sparse.half_difference[i] != 0;
      residual.replica = has_halves ? seen.replica - part * replica : replica_of_single_sample(i, residual.radiance);
    });
    return residuals;
  }

 private:
  static bool is_unlike_a_pinhole(const FirstHitSums& hits) { return hits.square_shift_px2 > 0 || hits.blended > 0; }

  template <class Visit>
  void for_each_site(const Visit& visit) const {
    parallel_for(map_.tiles.size(), input_.threads, [&](std::size_t t) {
      const MapTile& tile = map_.tiles[t];
      for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
        visit(i);
      }
    });
  }

  [[nodiscard]] bool is_known(std::size_t site) const { return input_.values.count(site) > 0; }

  [[nodiscard]] Seen seen_at(std::size_t site) const {
    if (!is_known(site)) {
      return {};
    }
    const FirstHitSums& hits = input_.sparse.first_hits[site];
    const float per_sample = 1.0F / static_cast<float>(input_.values.count(site));
    Seen seen{per_sample * hits.shone, hits.shone_difference};
    for (std::size_t s = cells_.first[site]; s < cells_.first[site + 1]; ++s) {
      const SurfaceSums& sums = input_.sparse.surfaces[s];
      const SurfaceCell& cell = cells_.cells[s];
      const Vec3f albedo = per_sample * sums.albedo;
      const auto light = [](float reflected, float reflectance) {
        return reflected / std::max(reflectance, kLeastAlbedo);
      };
      seen.radiance += albedo * Vec3f{light(cell.reflected.x, cell.albedo.x), light(cell.reflected.y, cell.albedo.y),
                                      light(cell.reflected.z, cell.albedo.z)};
      seen.replica += cell.light * sums.albedo_difference + luminance(albedo) * cell.replica;
    }
    return seen;
  }

  // visit(site, weight) for the sites around, the own one among them, that filters change.
  template <std::size_t kWeights, class Visit>
  void for_each_around(std::size_t site, const std::array<float, kWeights>& weights, const Visit& visit) const {
    constexpr int kReach = static_cast<int>(kWeights) - 1;
    const Site& own = map_.sites[site];
    const int block = map_.regions[own.region].block_px;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      const int y = (own.block_y + dy) * block + block / 2;
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int x = (own.block_x + dx) * block + block / 2;
        if ((dx != 0 || dy != 0) && (x < 0 || y < 0 || x >= map_.width_px || y >= map_.height_px)) {
          continue;
        }
        const std::size_t other = dx == 0 && dy == 0 ? site : cells_.site_of_pixel(x, y);
        if (is_known(other)) {
          visit(other, weights[static_cast<std::size_t>(std::abs(dx))] *
                           weights[static_cast<std::size_t>(std::abs(dy))] *
                           static_cast<float>(input_.values.count(other)));
        }
      }
    }
  }

  // How far the samples around a site are to be believed rather than the guides.
  [[nodiscard]] float share_at(std::size_t site) const {
    float samples = 0;
    float square_shift = 0;
    float blended = 0;
    for_each_around(site, kWide, [&](std::size_t other, float weight) {
      const FirstHitSums& hits = input_.sparse.first_hits[other];
      const float per_sample = weight / static_cast<float>(input_.values.count(other));
      samples += weight;
      square_shift += per_sample * hits.square_shift_px2;
      blended += per_sample * static_cast<float>(hits.blended);
    });
    if (!(samples > 0)) {
      return 0;
    }
    const auto block = static_cast<float>(map_.regions[map_.sites[site].region].block_px);
    const float shift = std::sqrt(square_shift / samples) / block;
    const auto pixels = static_cast<float>(map_.sites[site].pixels);
    const float density = static_cast<float>(input_.values.count(site)) / pixels;
    const float blurred = std::clamp((shift - kLeastShift) / (kFullShift - kLeastShift), 0.0F, 1.0F);
    const float seen_through =
        std::min(blended / samples / kFullyBlended, 1.0F) * density / (density + kRaysOfGuides * pixels);
    return std::max(blurred, seen_through);
  }

  // Of those sites that are to be believed.
  [[nodiscard]] Seen mean_around(std::size_t site) const {
    const float share = seen_[site].share;
    if (!(share > 0)) {
      return {};
    }
    Seen sum;
    float weights = 0;
    for_each_around(site, kNarrow, [&](std::size_t other, float weight) {
      const float w = weight * seen_[other].share;
      weights += w;
      sum.radiance += w * seen_[other].radiance;
      sum.replica += w * seen_[other].replica;
    });
    return weights > 0 ? Seen{sum.radiance / weights, sum.replica / weights, share} : Seen{};
  }

  // Radiance and replica are multiplied by the share.
  [[nodiscard]] Seen between_blocks(int x, int y) const {
    const int block = map_.regions[map_.region(x, y)].block_px;
    Seen sum;
    const auto add = [&](std::size_t site, float weight) {
      const Seen& around = around_[site];
      const float w = weight * around.share;
      sum.radiance += w * around.radiance;
      sum.replica += w * around.replica;
      sum.share += w;
    };
    if (block == 1) {
      add(cells_.site_of_pixel(x, y), 1);
      return sum;
    }
    const auto size = static_cast<float>(block);
    const float u = (static_cast<float>(x) + 0.5F) / size - 0.5F;
    const float v = (static_cast<float>(y) + 0.5F) / size - 0.5F;
    const int column = static_cast<int>(std::floor(u));
    const int row = static_cast<int>(std::floor(v));
    const float fx = u - std::floor(u);
    const float fy = v - std::floor(v);
    for (int k = 0; k < 4; ++k) {
      const int px = std::clamp((column + (k & 1)) * block + block / 2, 0, map_.width_px - 1);
      const int py = std::clamp((row + (k >> 1)) * block + block / 2, 0, map_.height_px - 1);
      add(cells_.site_of_pixel(px, py), ((k & 1) != 0 ? fx : 1.0F - fx) * ((k & 2) != 0 ? fy : 1.0F - fy));
    }
    return sum;
  }

  const FilterInput& input_;
  const SamplingMap& map_;
  const SurfaceCells& cells_;
  std::vector<Seen> seen_, around_;  // of each site
};

}  // namespace

void show_what_samples_saw(const FilterInput& input, const SurfaceCells& cells, const SmoothingSettings& settings,
                           SurfacePicture& picture) {
  const SampledFirstHits hits(input, cells);
  if (hits.any_takes_the_place()) {
    hits.show(picture);
  }
  picture.first_hits_variance = ImageGray(input.map.width_px, input.map.height_px);
  picture.first_hits_error = picture.first_hits_variance;
  keep_residuals(input, settings, cells.site_of_pixel, hits.residuals(picture), false, picture);
}

}  // namespace gazetrace
