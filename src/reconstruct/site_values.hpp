// SPDX-License-Identifier: Apache-2.0
// What the sums of a site say: means, the variance of the mean, and stand-ins where nothing was sampled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/luminance.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

struct SiteValue {
  Vec3f radiance;
  float variance = 0;  // of the mean luminance
};

struct SiteGuides {
  Vec3f albedo, normal;                                    // means over all samples; a miss counts as zero
  float depth_m = std::numeric_limits<float>::infinity();  // mean over the hits
  float hit_share = 0;
};

// Keeps a reference to `sparse`, which must outlive it.
class SiteValues {
 public:
  SiteValues(const SparseFrame& sparse, const SamplingMap& map, int threads);

  [[nodiscard]] SiteValue value(std::size_t site) const {
    return filled_.empty() ? value_from_sums(site) : filled_[site];
  }
  [[nodiscard]] SiteGuides guides(std::size_t site) const {
    return filled_guides_.empty() ? guides_from_sums(site) : filled_guides_[site];
  }
  [[nodiscard]] std::uint32_t count(std::size_t site) const { return sparse_->count[site]; }
  [[nodiscard]] bool has_guides() const { return !sparse_->guides.empty(); }

 private:
  [[nodiscard]] SiteValue value_from_sums(std::size_t site) const;
  [[nodiscard]] SiteGuides guides_from_sums(std::size_t site) const;
  [[nodiscard]] float variance_of_single(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel,
                                         std::uint32_t site, std::vector<std::uint32_t>& around) const;
  void estimate_single_variances(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel, int threads);
  void fill_empty_sites(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel);

  const SparseFrame* sparse_;
  // Of the sites with a single sample; empty unless there are any.
  std::vector<float> single_variances_;
  // Empty unless some site has no samples.
  std::vector<SiteValue> filled_;
  std::vector<SiteGuides> filled_guides_;
};

inline SiteValue SiteValues::value_from_sums(std::size_t site) const {
  const std::uint32_t count = sparse_->count[site];
  if (count == 0) {
    return {};
  }
  const auto n = static_cast<float>(count);
  const Vec3f sum = sparse_->sum[site];
  SiteValue value{{sum.x / n, sum.y / n, sum.z / n}, 0.0F};
  if (count > 1) {
    // The unbiased estimate of the samples' variance, divided by their number. In double, since two nearly equal
    // numbers are subtracted. Luminance as the tracer sums it.
    const double shone = luminance(to_double(sum));
    const double samples = count;
    const double spread =
        (static_cast<double>(sparse_->sum_square_luminance[site]) - shone * shone / samples) / (samples - 1.0);
    value.variance = spread > 0 ? static_cast<float>(spread / samples) : 0.0F;
  } else {
    value.variance = single_variances_[site];
  }
  return value;
}

}  // namespace gazetrace
