// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/keep_residuals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/block_bands.hpp"

namespace gazetrace {
namespace {

constexpr int kBands = 3;
constexpr float kMostShare = 4;  // of a block's residual, in a pixel that is much brighter than the rest of it
constexpr float kMostLight = 1e18F;

// The blocks of a region and some around them: [x, x + width) x [y, y + height) on the grid of the region.
struct BlockWindow {
  std::size_t region;
  int block_px, x, y, width, height;
};
constexpr int kAround = 16;  // blocks; what is farther away from a region has no part in its residuals

using Residuals = Channels<4>;  // red, green, blue, and a replica of the error of their luminance
using Powers = Channels<3>;     // as Power
using Plane = Channels<1>;

Vec3f radiance_of(const Residuals::Value& residual) {
  return {residual[0], residual[1], residual[2]};
}

// Mean squares, relative to the picture's own.
struct Power {
  float residual = 0, noise = 0;
  float spread = 0;  // mean square of `noise`
};
Power power_of(const Powers::Value& value) {
  return {value[0], value[1], value[2]};
}
Power operator+(const Power& a, const Power& b) {
  return {a.residual + b.residual, a.noise + b.noise, a.spread + b.spread};
}
Power operator*(float w, const Power& a) {
  return {w * a.residual, w * a.noise, w * a.spread};
}

// Means over squares of about 16 pixels and their eight neighbours, and between their centres.
class TileMeans {
 public:
  TileMeans(const Powers& image, int block_px, int threads)
      : tile_(std::max(16 / block_px, 1)),
        columns_((image.width + tile_ - 1) / tile_),
        rows_((image.height + tile_ - 1) / tile_) {
    std::vector<Power> sums(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    parallel_for(static_cast<std::size_t>(rows_), threads, [&](std::size_t row) {
      const int y0 = static_cast<int>(row) * tile_;
      const int y1 = std::min(y0 + tile_, image.height);
      for (int column = 0; column < columns_; ++column) {
        const int x0 = column * tile_;
        const int x1 = std::min(x0 + tile_, image.width);
        std::array<double, 3> sum{};
        for (int y = y0; y < y1; ++y) {
          for (int x = x0; x < x1; ++x) {
            const Power p = power_of(image.at(x, y));
            sum[0] += static_cast<double>(p.residual);
            sum[1] += static_cast<double>(p.noise);
            sum[2] += static_cast<double>(p.spread);
          }
        }
        const double blocks = static_cast<double>((x1 - x0) * (y1 - y0));
        sums[index(column, static_cast<int>(row))] = {static_cast<float>(sum[0] / blocks),
                                                      static_cast<float>(sum[1] / blocks),
                                                      static_cast<float>(sum[2] / blocks)};
      }
    });
    means_.resize(sums.size());
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        Power& mean = means_[index(x, y)];
        for (int v = y - 1; v <= y + 1; ++v) {
          for (int u = x - 1; u <= x + 1; ++u) {
            mean = mean + (1.0F / 9) * sums[index(std::clamp(u, 0, columns_ - 1), std::clamp(v, 0, rows_ - 1))];
          }
        }
      }
    }
  }

  // So many blocks are in a mean.
  [[nodiscard]] int blocks() const { return 9 * tile_ * tile_; }

  [[nodiscard]] Power at(int x, int y) const {
    const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(tile_) - 0.5F;
    const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(tile_) - 0.5F;
    const int column = static_cast<int>(std::floor(u));
    const int row = static_cast<int>(std::floor(v));
    const float fx = u - static_cast<float>(column);
    const float fy = v - static_cast<float>(row);
    const auto mean = [&](int dx, int dy) -> const Power& {
      return means_[index(std::clamp(column + dx, 0, columns_ - 1), std::clamp(row + dy, 0, rows_ - 1))];
    };
    return (1 - fy) * ((1 - fx) * mean(0, 0) + fx * mean(1, 0)) + fy * ((1 - fx) * mean(0, 1) + fx * mean(1, 1));
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int tile_, columns_, rows_;
  std::vector<Power> means_;
};

std::vector<SiteResidual> residuals_of_sites(const FilterInput& input, const SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  std::vector<SiteResidual> residuals(map.sites.size());
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (input.values.count(i) == 0 || !input.pass_through.needs_filtering(i)) {
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
      residual.shown = share * luminance(mean);
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

// Of each region; empty where it has no sites.
std::vector<BlockWindow> windows_of_regions(const SamplingMap& map) {
  struct Extent {
    int x = std::numeric_limits<int>::max(), y = std::numeric_limits<int>::max(), x_end = 0, y_end = 0;
  };
  std::vector<Extent> extents(map.regions.size());
  for (const Site& site : map.sites) {
    Extent& e = extents[site.region];
    e.x = std::min<int>(e.x, site.block_x);
    e.y = std::min<int>(e.y, site.block_y);
    e.x_end = std::max(e.x_end, site.block_x + 1);
    e.y_end = std::max(e.y_end, site.block_y + 1);
  }
  std::vector<BlockWindow> windows;
  for (std::size_t r = 0; r < extents.size(); ++r) {
    const Extent& e = extents[r];
    const int block = map.regions[r].block_px;
    if (e.x_end == 0) {
      windows.push_back({r, block, 0, 0, 0, 0});
      continue;
    }
    const int x = std::max(e.x - kAround, 0);
    const int y = std::max(e.y - kAround, 0);
    windows.push_back({r, block, x, y, std::min(e.x_end + kAround, (map.width_px + block - 1) / block) - x,
                       std::min(e.y_end + kAround, (map.height_px + block - 1) / block) - y});
  }
  return windows;
}

// The site that stands for each block of a window: the region's own; where the region has no pixel, that in the middle.
std::vector<std::uint32_t> sites_of_blocks(const FilterInput& input, const BlockWindow& window,
                                           const Image<std::uint32_t>& site_of_pixel) {
  const SamplingMap& map = input.map;
  std::vector<std::uint32_t> sites(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height));
  const int block = window.block_px;
  for_each_row(window.height, input.threads, [&](int y) {
    std::uint32_t* row = &sites[static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width)];
    const int py = std::min((window.y + y) * block + block / 2, map.height_px - 1);
    for (int x = 0; x < window.width; ++x) {
      row[x] = site_of_pixel(std::min((window.x + x) * block + block / 2, map.width_px - 1), py);
    }
  });
  if (block > 1) {
    parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
      const MapTile& tile = map.tiles[t];
      for (std::uint32_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
        const Site& site = map.sites[i];
        if (site.region == window.region) {
          sites[static_cast<std::size_t>(site.block_y - window.y) * static_cast<std::size_t>(window.width) +
                static_cast<std::size_t>(site.block_x - window.x)] = i;
        }
      }
    });
  }
  return sites;
}

// What is given back of a block's residual, and what becomes of the picture's estimates there.
struct KeptResidual {
  Vec3f radiance;
  float rest = 1;  // the share of the finest band that is not given back
  float variance = 0, error = 0;
  float shown = 0;  // as SiteResidual
};

// Where light is rare, some pixels have it in both halves by chance, so that their replicas are small and their
// residuals look like details. Of noise that is mostly nothing and at times s, the mean of fourth powers over that of
// squares is s squared; of normal noise it is three times its variance, which is left out. Twice s is what both halves
// show together, three times s when one of them has it twice.
float square_of_coincidence(const Power& wide) {
  constexpr float kEvents = 3;
  const float rare = wide.noise > 0 ? wide.spread / wide.noise - 3 * wide.noise : 0.0F;
  return rare > 0 ? kEvents * kEvents * rare : 0.0F;  // no number where squares were infinite
}

// The share of a residual that is no noise: what follows from the signal that is there on average far around and from
// the noise near the pixel (a rare bright sample is noise there), and more where there is more signal near the pixel.
// Both signals must be beyond doubt. `near` was smoothed twice; `wide` is the mean of `independent` squares.
float share_to_keep(const Power& near, const Power& wide, float independent, float doubt) {
  // The sum of the squares of the weights 1 4 6 4 1 / 16 in both directions: one over the number of squares in `near`.
  constexpr float kWeightsSquared = 0.0748F;
  // Less doubt far around: signal that is missed there costs more than noise that is kept.
  constexpr float kWideDoubt = 2;
  const float spread = 2 * std::max(near.spread, wide.spread);
  const float near_signal = near.residual - near.noise - doubt * std::sqrt(kWeightsSquared * spread) -
                            kWeightsSquared * square_of_coincidence(wide);
  const float wide_signal = wide.residual - wide.noise - kWideDoubt * std::sqrt(2 * wide.spread / independent);
  const float share =
      std::max(near_signal > 0 ? near_signal / near.residual : 0.0F,
               wide_signal > 0 ? wide_signal / (wide_signal + std::max(0.5F * near.noise, wide.noise)) : 0.0F);
  return share > 0 ? std::min(share, 1.0F) : 0.0F;  // no number where squares were infinite
}

// Of a residual whose replica is far beyond what residuals and noise are far around, one half of the samples knows
// nothing: a rare bright sample. It fades by the square of the excess, and the smoothed light around it keeps what the
// sample brought. `replica_squared`: relative, as squares are in `wide`.
float share_of_confirmed(float replica_squared, const Power& wide, float most_deviations) {
  const float most = most_deviations * most_deviations * std::max(wide.residual, wide.noise);
  return replica_squared > most ? most / replica_squared : 1.0F;
}

// The residuals of the blocks of one region, and what is kept of them.
class RegionResiduals {
 public:
  RegionResiduals(const FilterInput& input, const SmoothingSettings& settings, const BlockWindow& window,
                  const std::vector<SiteResidual>& of_site, const Image<std::uint32_t>& site_of_pixel,
                  const SurfacePicture& picture)
      : window_(window),
        most_deviations_(settings.most_deviations),
        threads_(input.threads),
        finer_(window.width, window.height),
        light_(window.width, window.height),
        doubt_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height)),
        kept_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height)) {
    const std::vector<std::uint32_t> sites = sites_of_blocks(input, window, site_of_pixel);
    for_each_row(window.height, threads_, [&](int y) {
      for (int x = 0; x < window.width; ++x) {
        const std::uint32_t site = sites[index(x, y)];
        const SiteResidual& r = of_site[site];
        finer_.put(x, y, {r.radiance.x, r.radiance.y, r.radiance.z, r.replica});
        const float shown = shown_by_site(input.map, site, r, picture);
        kept_[index(x, y)].shown = shown;
        doubt_[index(x, y)] =
            settings.residual_doubt * doubt_of_few(static_cast<float>(input.values.count(site)), settings);
        light_.put(x, y, {shown});
      }
    });
    keep_bands();
  }

  [[nodiscard]] int first_column() const { return window_.x; }
  [[nodiscard]] int columns() const { return window_.width; }
  [[nodiscard]] bool has_row(int block_y) const { return block_y >= window_.y && block_y < window_.y + window_.height; }
  // has_row(block_y) must be true.
  [[nodiscard]] const KeptResidual* row(int block_y) const { return &kept_[index(0, block_y - window_.y)]; }
  // Beyond the window the last block is repeated.
  [[nodiscard]] const KeptResidual& at(int block_x, int block_y) const {
    return kept_[index(std::clamp(block_x - window_.x, 0, window_.width - 1),
                       std::clamp(block_y - window_.y, 0, window_.height - 1))];
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.width) + static_cast<std::size_t>(x);
  }

  // Also of sites without a residual.
  static float shown_by_site(const SamplingMap& map, std::uint32_t site, const SiteResidual& residual,
                             const SurfacePicture& picture) {
    if (residual.shown > 0) {
      return residual.shown;
    }
    float sum = 0;
    for_each_pixel(map, map.sites[site], [&](int x, int y) { sum += luminance(picture.radiance(x, y)); });
    return sum / static_cast<float>(map.sites[site].pixels);
  }

  // One over the mean square of the picture around each block. Squares are taken in relation to it, so that a bright
  // neighbour does not decide for all.
  [[nodiscard]] Plane relative_scale() const {
    Plane scale(window_.width, window_.height);
    Plane scratch(window_.width, window_.height);
    for_each_row(window_.height, threads_, [&](int y) {
      for (int x = 0; x < window_.width; ++x) {
        // Without a limit, squares of light near the end of float's range would not be finite.
        const float light = std::min(light_.at(x, y)[0], kMostLight);
        const float noise = std::clamp(finer_.at(x, y)[3], -kMostLight, kMostLight);
        scale.put(x, y, {light * light + noise * noise});
      }
    });
    for (const int step : {1, 2, 4}) {
      smooth(step, threads_, scale, scratch, scale);
    }
    for (float& value : scale.values) {
      value = 1.0F / (value + 1e-30F);
    }
    return scale;
  }

  void keep_bands() {
    const Plane scale = relative_scale();
    Residuals coarser(window_.width, window_.height);
    Residuals scratch(window_.width, window_.height);
    for (int band = 0; band < kBands; ++band) {
      const bool last = band + 1 == kBands;
      if (!last) {
        smooth(1 << band, threads_, finer_, scratch, coarser);
      }
      keep_band(band, scale, last ? nullptr : &coarser);
      std::swap(finer_, coarser);
    }
  }

  // What the finer residuals have beyond the coarser ones; all of them where there are no coarser ones.
  [[nodiscard]] Residuals::Value detail(const Residuals* coarser, int x, int y) const {
    Residuals::Value d = finer_.at(x, y);
    if (coarser != nullptr) {
      const Residuals::Value c = coarser->at(x, y);
      for (std::size_t k = 0; k < d.size(); ++k) {
        d[k] -= c[k];
      }
    }
    return d;
  }

  void keep_band(int band, const Plane& scales, const Residuals* coarser) {
    const int step = 1 << band;
    Powers power(window_.width, window_.height);
    Powers scratch(window_.width, window_.height);
    for_each_row(window_.height, threads_, [&](int y) {
      for (int x = 0; x < window_.width; ++x) {
        const Residuals::Value d = detail(coarser, x, y);
        const float scale = scales.at(x, y)[0];
        const float light = luminance(radiance_of(d));
        const float noise = scale * d[3] * d[3];
        power.put(x, y, {scale * light * light, noise, noise * noise});
      }
    });
    const TileMeans wide(power, window_.block_px, threads_);
    // Residuals of a band are alike over `step` blocks.
    const float independent = static_cast<float>(wide.blocks()) / static_cast<float>(step * step);
    smooth(step, threads_, power, scratch, power);
    smooth(step, threads_, power, scratch, power);
    for_each_row(window_.height, threads_, [&](int y) {
      for (int x = 0; x < window_.width; ++x) {
        const Residuals::Value d = detail(coarser, x, y);
        const Power p = power_of(power.at(x, y));
        const float scale = scales.at(x, y)[0];
        const Power around = wide.at(x, y);
        const float share = share_of_confirmed(scale * d[3] * d[3], around, most_deviations_) *
                            share_to_keep(p, around, independent, doubt_[index(x, y)]);
        KeptResidual& kept = kept_[index(x, y)];
        kept.radiance += share * radiance_of(d);
        const float rest = 1.0F - share;
        constexpr float kMost = kMostLight * kMostLight;
        const float noise = std::min(kMost, p.noise / scale);  // kMost also for what is no number
        const float bias = std::min(kMost, std::max(0.0F, p.residual - p.noise) / scale);
        kept.rest = band == 0 ? rest : kept.rest;
        kept.variance += share * share * noise;
        kept.error += share * share * noise + rest * rest * bias;
      }
    });
  }

  BlockWindow window_;
  float most_deviations_;
  int threads_;
  Residuals finer_;
  Plane light_;               // mean luminance of the picture
  std::vector<float> doubt_;  // of each block's residual
  std::vector<KeptResidual> kept_;
};

void add(float weight, const KeptResidual& kept, KeptResidual& sum) {
  sum.radiance += weight * kept.radiance;
  sum.rest += weight * kept.rest;
  sum.variance += weight * kept.variance;
  sum.error += weight * kept.error;
  sum.shown += weight * kept.shown;
}

// Where a pixel lies between the centres of two blocks.
struct Between {
  int block;       // the first of them
  float fraction;  // of the way to the other
};
Between between_blocks(int pixel, int block_px) {
  const float at = (static_cast<float>(pixel) + 0.5F) / static_cast<float>(block_px) - 0.5F;
  const float block = std::floor(at);
  return {static_cast<int>(block), at - block};
}

// What is kept of the residuals of a region in the pixels of one row; nothing where the region has none there.
class RowOfResiduals {
 public:
  RowOfResiduals(const RegionResiduals& residuals, int block_px, int y)
      : block_px_(block_px), first_(residuals.first_column() - 1) {
    if (!residuals.has_row(y / block_px)) {
      return;
    }
    if (block_px == 1) {
      first_ = residuals.first_column();
      of_blocks_ = residuals.row(y);
      return;
    }
    // First between the rows of blocks, for the blocks of the row and one on each side.
    const auto [row, fraction] = between_blocks(y, block_px);
    interpolated_.resize(static_cast<std::size_t>(residuals.columns()) + 2);
    for (std::size_t k = 0; k < interpolated_.size(); ++k) {
      const int column = first_ + static_cast<int>(k);
      KeptResidual& kept = interpolated_[k];
      kept.rest = 0;
      add(1.0F - fraction, residuals.at(column, row), kept);
      add(fraction, residuals.at(column, row + 1), kept);
    }
    of_blocks_ = interpolated_.data();
  }
  RowOfResiduals(RowOfResiduals&&) = default;

  // The pixels of a block share its residual in proportion to what they show (`light`): what is wrong with light is
  // wrong by a factor.
  [[nodiscard]] KeptResidual at(int x, float light) const {
    if (block_px_ == 1) {
      return of_blocks_[x - first_];
    }
    const auto [column, fraction] = between_blocks(x, block_px_);
    KeptResidual sum;
    sum.rest = 0;
    add(1.0F - fraction, of_blocks_[column - first_], sum);
    add(fraction, of_blocks_[column + 1 - first_], sum);
    const float share = sum.shown > 0 ? std::min(light / sum.shown, kMostShare) : 1.0F;
    sum.radiance = share * sum.radiance;
    sum.variance *= share * share;
    sum.error *= share * share;
    return sum;
  }

 private:
  int block_px_, first_;
  std::vector<KeptResidual> interpolated_;
  const KeptResidual* of_blocks_ = nullptr;  // from block `first_` on
};

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
                    bool estimates, SurfacePicture& picture) {
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
      const bool filtered = map.regions[region].block_px > 1 || input.pass_through.needs_filtering(site_of_pixel(x, y));
      const std::size_t i = picture.radiance.index(x, y);
      Vec3f& radiance = picture.radiance.pixels[i];
      const KeptResidual kept = rows[region].at(x, luminance(radiance));
      if (filtered) {
        const Vec3f value = radiance + kept.radiance;
        radiance = {std::max(value.x, 0.0F), std::max(value.y, 0.0F), std::max(value.z, 0.0F)};
      }
      if (estimates) {
        const float rest = kept.rest * kept.rest;
        picture.variance.pixels[i] = rest * picture.variance.pixels[i] + kept.variance;
        picture.error.pixels[i] = rest * picture.error.pixels[i] + kept.error;
      }
    }
  });
}

}  // namespace gazetrace
