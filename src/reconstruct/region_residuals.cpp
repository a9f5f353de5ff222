// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/region_residuals.hpp"

#include <cmath>
#include <utility>

#include "core/luminance.hpp"
#include "foveation/sites.hpp"

namespace gazetrace {
namespace {

constexpr int kBands = 3;
constexpr float kMostShare = 4;  // of a block's residual, in a pixel that is much brighter than the rest of it
constexpr float kMostLight = 1e18F;
// Coarse bands change a block by this share of what it shows at most, unless its own samples say more. Beside a light,
// coarse residuals are those of the light: without this limit they would make the wall around it black, or glow.
constexpr float kMostChange = 0.1F;

Vec3f radiance_of(const Channels<4>::Value& residual) {
  return {residual[0], residual[1], residual[2]};
}

// Also of sites without a residual.
Vec3f shown_by_site(const SamplingMap& map, std::uint32_t site, const SiteResidual& residual,
                    const SurfacePicture& picture) {
  if (luminance(residual.shown) > 0) {
    return residual.shown;
  }
  Vec3f sum;
  for_each_pixel(map, map.sites[site], [&](int x, int y) { sum += picture.radiance(x, y); });
  return (1.0F / static_cast<float>(map.sites[site].pixels)) * sum;
}

// `kept`: of a residual, by all bands together. `own`: the residual by the block's own samples.
float bounded(float kept, float shown, float own) {
  return std::clamp(kept, std::min(-kMostChange * shown, own), std::max(kMostChange * shown, own));
}
Vec3f bounded(const Vec3f& kept, const Vec3f& shown, const Vec3f& own) {
  return {bounded(kept.x, shown.x, own.x), bounded(kept.y, shown.y, own.y), bounded(kept.z, shown.z, own.z)};
}

// What is left of a residual far beyond its own samples' standard error is wrong with the picture, whatever is around
// it: dark blocks beside bright ones are hidden by the noise of those. A rare bright sample is not taken for that: it
// makes the two alike, and m of them make the square m times the other. Samples that have seen none know nothing of it,
// so that less light than the picture has must be beyond what is seen near as well.
void keep_what_is_sure(const SiteResidual& residual, float own_variance, float noise_near, float samples,
                       KeptResidual& kept) {
  constexpr float kSure = 6, kMany = 16;
  const Vec3f left = residual.radiance - kept.radiance;
  const float light = luminance(left);
  const float variance = light > 0 ? own_variance : std::max(own_variance, noise_near);
  const float least = kSure * (1 + kMany / std::max(samples, 1.0F)) * variance;
  const float square = light * light;
  if (samples < kMany || !(square > least) || !(square <= kMostLight * kMostLight)) {
    return;
  }
  const float share = 1 - least / square;
  const float rest = 1 - share;
  kept.radiance += share * left;
  kept.rest *= rest;
  kept.variance = rest * rest * kept.variance + (1 - rest * rest) * variance;
  kept.error = rest * rest * kept.error + (1 - rest * rest) * variance;
}

void add(float weight, const KeptResidual& kept, KeptResidual& sum) {
  sum.radiance += weight * kept.radiance;
  sum.rest += weight * kept.rest;
  sum.variance += weight * kept.variance;
  sum.error += weight * kept.error;
  sum.replica += weight * kept.replica;
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

}  // namespace

RegionResiduals::RegionResiduals(const FilterInput& input, const SmoothingSettings& settings, const BlockWindow& window,
                                 const std::vector<SiteResidual>& of_site, const Image<std::uint32_t>& site_of_pixel,
                                 const SurfacePicture& picture)
    : window_(window),
      most_deviations_(settings.most_deviations),
      threads_(input.threads),
      finer_(window.width, window.height),
      light_(window.width, window.height),
      doubt_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height)),
      noise_(doubt_.size()),
      kept_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height)) {
  const std::vector<std::uint32_t> sites = sites_of_blocks(input, window, site_of_pixel);
  for_each_row(window.height, threads_, [&](int y) {
    for (int x = 0; x < window.width; ++x) {
      const std::uint32_t site = sites[index(x, y)];
      const SiteResidual& r = of_site[site];
      finer_.put(x, y, {r.radiance.x, r.radiance.y, r.radiance.z, r.replica});
      const float shown = luminance(shown_by_site(input.map, site, r, picture));
      kept_[index(x, y)].shown = shown;
      doubt_[index(x, y)] =
          settings.residual_doubt * doubt_of_few(static_cast<float>(input.values.count(site)), settings);
      light_.put(x, y, {shown});
    }
  });
  keep_bands();
  for_each_row(window.height, threads_, [&](int y) {
    for (int x = 0; x < window_.width; ++x) {
      const std::uint32_t site = sites[index(x, y)];
      const SiteResidual& own = of_site[site];
      KeptResidual& kept = kept_[index(x, y)];
      kept.radiance = bounded(kept.radiance, shown_by_site(input.map, site, own, picture), own.radiance);
      keep_what_is_sure(own, input.values.value(site).variance, noise_[index(x, y)],
                        static_cast<float>(input.values.count(site)), kept);
    }
  });
}

// One over the mean square of the picture around each block. Squares are taken in relation to it, so that a bright
// neighbour does not decide for all.
RegionResiduals::Plane RegionResiduals::relative_scale() const {
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

void RegionResiduals::keep_bands() {
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
RegionResiduals::Residuals::Value RegionResiduals::detail(const Residuals* coarser, int x, int y) const {
  Residuals::Value d = finer_.at(x, y);
  if (coarser != nullptr) {
    const Residuals::Value c = coarser->at(x, y);
    for (std::size_t k = 0; k < d.size(); ++k) {
      d[k] -= c[k];
    }
  }
  return d;
}

void RegionResiduals::keep_band(int band, const Plane& scales, const Residuals* coarser) {
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
      kept.replica += share * d[3];
      const float rest = 1.0F - share;
      constexpr float kMost = kMostLight * kMostLight;
      const float noise = std::min(kMost, p.noise / scale);  // kMost also for what is no number
      const float bias = std::min(kMost, std::max(0.0F, p.residual - p.noise) / scale);
      kept.rest = band == 0 ? rest : kept.rest;
      noise_[index(x, y)] += noise;
      kept.variance += share * share * noise;
      kept.error += share * share * noise + rest * rest * bias;
    }
  });
}

RowOfResiduals::RowOfResiduals(const RegionResiduals& residuals, int block_px, int y)
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
KeptResidual RowOfResiduals::at(int x, float light) const {
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
  sum.replica *= share;
  return sum;
}

}  // namespace gazetrace
