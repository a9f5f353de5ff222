// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/site_values.hpp"

#include <algorithm>
#include <utility>

#include "core/parallel.hpp"
#include "foveation/site_images.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// A weighted mean of sites. Variances are averaged and not divided by the number of sites, since a place that was never
// sampled is known no better than its neighbours.
struct Average {
  Vec3d radiance, albedo, normal;
  double variance = 0, depth_m = 0, hits = 0, weight = 0;

  void add(double w, const SiteValue& value, const SiteGuides& guides) {
    weight += w;
    radiance += w * to_double(value.radiance);
    variance += w * static_cast<double>(value.variance);
    albedo += w * to_double(guides.albedo);
    normal += w * to_double(guides.normal);
    if (guides.hit_share > 0) {
      const double h = w * static_cast<double>(guides.hit_share);
      hits += h;
      depth_m += h * static_cast<double>(guides.depth_m);
    }
  }
  [[nodiscard]] SiteValue value() const { return {to_float(radiance / weight), static_cast<float>(variance / weight)}; }
  [[nodiscard]] SiteGuides guides() const {
    SiteGuides g{to_float(albedo / weight), to_float(normal / weight)};
    if (hits > 0) {
      g.depth_m = static_cast<float>(depth_m / hits);
      g.hit_share = static_cast<float>(hits / weight);
    }
    return g;
  }
};

// Calls visit(neighbor) with the site of every pixel in or around the site's block that is not its own.
template <class Visit>
void for_each_neighbor(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel, std::uint32_t site,
                       const Visit& visit) {
  const BlockRect rect = block_rect(map, map.sites[site]);
  for (int y = std::max(rect.y - 1, 0); y < std::min(rect.y_end + 1, map.height_px); ++y) {
    for (int x = std::max(rect.x - 1, 0); x < std::min(rect.x_end + 1, map.width_px); ++x) {
      if (site_of_pixel(x, y) != site) {
        visit(site_of_pixel(x, y));
      }
    }
  }
}

}  // namespace

SiteValues::SiteValues(const SparseFrame& sparse, const SamplingMap& map, int threads) : sparse_(&sparse) {
  const std::size_t sites = map.sites.size();
  if (sparse.width_px != map.width_px || sparse.height_px != map.height_px || sparse.sum.size() != sites ||
      sparse.sum_square_luminance.size() != sites || sparse.count.size() != sites ||
      (!sparse.guides.empty() && sparse.guides.size() != sites)) {
    throw Error(ErrorKind::runtime, "reconstruct", "the samples were not traced with this sampling map",
                "pass the map that the tracer was given");
  }
  const auto some_have = [&](std::uint32_t count) {
    return std::find(sparse.count.begin(), sparse.count.end(), count) != sparse.count.end();
  };
  const bool some_empty = some_have(0);
  const bool some_single = some_have(1);
  if (!some_empty && !some_single) {
    return;
  }
  const Image<std::uint32_t> site_of_pixel = sites_of_pixels(map, threads);
  if (some_single) {
    estimate_single_variances(map, site_of_pixel, threads);
  }
  if (some_empty) {
    fill_empty_sites(map, site_of_pixel);
  }
}

// The spread of all samples in and around the site: its own one says nothing of it. What differs between places is in
// it, so that it is rather too large. Where there is no other sample, the spread counts as large as the light.
// `around`: what it holds is lost.
float SiteValues::variance_of_single(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel,
                                     std::uint32_t site, std::vector<std::uint32_t>& around) const {
  around.assign(1, site);
  for_each_neighbor(map, site_of_pixel, site, [&](std::uint32_t neighbor) {
    if (std::find(around.begin(), around.end(), neighbor) == around.end()) {
      around.push_back(neighbor);
    }
  });
  double samples = 0;
  double light = 0;
  double squares = 0;
  for (const std::uint32_t i : around) {
    samples += static_cast<double>(count(i));
    light += luminance(to_double(sparse_->sum[i]));
    squares += static_cast<double>(sparse_->sum_square_luminance[i]);
  }
  return static_cast<float>(samples > 1 ? std::max(squares - light * light / samples, 0.0) / (samples - 1) : squares);
}

void SiteValues::estimate_single_variances(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel,
                                           int threads) {
  single_variances_.resize(map.sites.size());
  parallel_for(map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    std::vector<std::uint32_t> around;
    for (std::uint32_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (count(i) == 1) {
        single_variances_[i] = variance_of_single(map, site_of_pixel, i, around);
      }
    }
  });
}

SiteGuides SiteValues::guides_from_sums(std::size_t site) const {
  if (sparse_->guides.empty() || sparse_->count[site] == 0) {
    return {};
  }
  const GuideSums& sums = sparse_->guides[site];
  const auto n = static_cast<float>(sparse_->count[site]);
  SiteGuides guides{sums.albedo / n, sums.normal / n};
  if (sums.hits > 0) {
    guides.depth_m = sums.depth_m / static_cast<float>(sums.hits);
    guides.hit_share = static_cast<float>(sums.hits) / n;
  }
  return guides;
}

// Ring by ring outwards from the sampled sites: each empty site takes the mean of the neighbouring pixels whose values
// were known a ring earlier, weighted by samples per pixel. Each site is visited twice, however large the hole is.
void SiteValues::fill_empty_sites(const SamplingMap& map, const Image<std::uint32_t>& site_of_pixel) {
  const std::size_t sites = map.sites.size();
  filled_.resize(sites);
  filled_guides_.resize(has_guides() ? sites : 0);
  std::vector<float> weight(sites, 0.0F);  // samples per pixel; 0: not known yet
  std::vector<std::uint32_t> known;
  for (std::size_t i = 0; i < sites; ++i) {
    if (count(i) != 0) {
      filled_[i] = value_from_sums(i);
      if (has_guides()) {
        filled_guides_[i] = guides_from_sums(i);
      }
      weight[i] = static_cast<float>(count(i)) / static_cast<float>(map.sites[i].pixels);
      known.push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::vector<bool> queued(sites, false);
  while (!known.empty()) {
    std::vector<std::uint32_t> ring;
    for (const std::uint32_t site : known) {
      for_each_neighbor(map, site_of_pixel, site, [&](std::uint32_t neighbor) {
        if (weight[neighbor] <= 0 && !queued[neighbor]) {
          queued[neighbor] = true;
          ring.push_back(neighbor);
        }
      });
    }
    std::vector<float> ring_weight;
    for (const std::uint32_t site : ring) {
      Average average;
      int pixels = 0;
      const auto take = [&](std::uint32_t neighbor) {
        if (weight[neighbor] > 0) {
          ++pixels;
          average.add(static_cast<double>(weight[neighbor]), filled_[neighbor],
                      has_guides() ? filled_guides_[neighbor] : SiteGuides{});
        }
      };
      for_each_neighbor(map, site_of_pixel, site, take);
      if (pixels == 0) {
        // Reached over the corner of a straddling block only: the other site's block touches this one's pixels, not
        // the other way round. Its ring comes later.
        queued[site] = false;
        ring_weight.push_back(0.0F);
        continue;
      }
      filled_[site] = average.value();
      if (has_guides()) {
        filled_guides_[site] = average.guides();
      }
      ring_weight.push_back(static_cast<float>(average.weight / pixels));
    }
    known.clear();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      weight[ring[i]] = ring_weight[i];
      if (ring_weight[i] > 0) {
        known.push_back(ring[i]);
      }
    }
  }
}

}  // namespace gazetrace
