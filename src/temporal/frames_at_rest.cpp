// SPDX-License-Identifier: Apache-2.0
#include "temporal/frames_at_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "trace/samples/surface_sums.hpp"

namespace gazetrace {
namespace {

std::uint8_t half_of(const SamplesOfFrame& one) {
  return static_cast<std::uint8_t>(one.frame & 1);
}

// Adds up the sums of one site after the other.
class SiteAdder {
 public:
  SiteAdder(const std::vector<SamplesOfFrame>& frames, const GuideCamera* camera, SparseFrame& out)
      : frames_(frames),
        out_(out),
        sorter_(camera != nullptr ? std::sqrt(dot(camera->up_step, camera->up_step)) : 0.0F,
                camera == nullptr || camera->perspective) {}

  // Appends the site's surfaces to `surfaces`.
  void add_site(std::size_t site, std::vector<SurfaceSums>& surfaces) {
    Vec3d sum;
    double square = 0;
    std::array<double, 2> bright{};
    std::array<std::uint32_t, 2> count{};
    for (const SamplesOfFrame& one : frames_) {
      const SparseFrame& sparse = *one.sparse;
      const Vec3d light = to_double(sparse.sum[site]);
      sum += light;
      square += static_cast<double>(sparse.sum_square_luminance[site]);
      bright[half_of(one)] += luminance(light);
      count[half_of(one)] += sparse.count[site];
    }
    out_.sum[site] = to_float(sum);
    out_.sum_square_luminance[site] = saturated(square);
    out_.count[site] = count[0] + count[1];
    if (!out_.guides.empty()) {
      add_guides(site);
    }
    if (!out_.light_groups.empty()) {
      add_light_groups(site);
    }
    if (!out_.half_difference.empty()) {
      out_.half_difference[site] = half_difference(bright, count);
    }
    if (!out_.first_half.empty()) {
      add_first_half(site);
    }
    if (!out_.first_surface.empty()) {
      add_surfaces(site, count, surfaces);
    }
    if (!out_.first_hits.empty()) {
      add_first_hits(site, count);
    }
  }

 private:
  void add_surfaces(std::size_t site, const std::array<std::uint32_t, 2>& count, std::vector<SurfaceSums>& surfaces) {
    for (const SamplesOfFrame& one : frames_) {
      const SparseFrame& sparse = *one.sparse;
      for (std::size_t s = sparse.first_surface[site]; s < sparse.first_surface[site + 1]; ++s) {
        sorter_.add(sparse.surfaces[s], half_of(one));
      }
    }
    const std::size_t before = surfaces.size();
    sorter_.finish_site(out_.first_hits.empty() ? std::array<std::uint32_t, 2>{} : count, surfaces);
    out_.first_surface[site] = static_cast<std::uint32_t>(surfaces.size() - before);
  }

  // Of the frames with even numbers, as half_of() has it.
  void add_first_half(std::size_t site) {
    Vec3d radiance;
    for (const SamplesOfFrame& one : frames_) {
      if (half_of(one) == 0) {
        radiance += to_double(one.sparse->sum[site]);
        out_.first_half[site].count += one.sparse->count[site];
      }
    }
    out_.first_half[site].radiance = to_float(radiance);
  }

  void add_guides(std::size_t site) {
    Vec3d albedo;
    Vec3d normal;
    double depth_m = 0;
    GuideSums& to = out_.guides[site];
    for (const SamplesOfFrame& one : frames_) {
      const GuideSums& from = one.sparse->guides[site];
      albedo += to_double(from.albedo);
      normal += to_double(from.normal);
      depth_m += static_cast<double>(from.depth_m);
      to.hits += from.hits;
    }
    to.albedo = to_float(albedo);
    to.normal = to_float(normal);
    to.depth_m = saturated(depth_m);
  }

  void add_light_groups(std::size_t site) {
    LightGroupSums& to = out_.light_groups[site];
    for (std::size_t group = 0; group < to.sum.size(); ++group) {
      Vec3d sum;
      for (const SamplesOfFrame& one : frames_) {
        sum += to_double(one.sparse->light_groups[site].sum[group]);
      }
      to.sum[group] = to_float(sum);
    }
  }

  void add_first_hits(std::size_t site, const std::array<std::uint32_t, 2>& count) {
    Vec3d shone;
    double square_shift = 0;
    std::array<double, 2> bright{};
    FirstHitSums& to = out_.first_hits[site];
    for (const SamplesOfFrame& one : frames_) {
      const FirstHitSums& from = one.sparse->first_hits[site];
      shone += to_double(from.shone);
      bright[half_of(one)] += luminance(to_double(from.shone));
      square_shift += static_cast<double>(from.square_shift_px2);
      to.blended += from.blended;
    }
    to.shone = to_float(shone);
    to.shone_difference = half_difference(bright, count);
    to.square_shift_px2 = saturated(square_shift);
  }

  const std::vector<SamplesOfFrame>& frames_;
  SparseFrame& out_;
  SurfaceSorter sorter_;
};

SamplingMap map_of_all(const std::vector<SamplesOfFrame>& frames) {
  SamplingMap map = *frames.front().map;
  std::vector<double> expected(map.expected_samples.begin(), map.expected_samples.end());
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const SamplingMap& other = *frames[k].map;
    for (std::size_t i = 0; i < map.sites.size(); ++i) {
      map.sites[i].samples += other.sites[i].samples;
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
      expected[i] += other.expected(i);
    }
    for (std::size_t i = 0; i < map.regions.size(); ++i) {
      map.regions[i].samples += other.regions[i].samples;
      map.regions[i].nominal_samples += other.regions[i].nominal_samples;
    }
    for (std::size_t i = 0; i < map.tiles.size(); ++i) {
      map.tiles[i].samples += other.tiles[i].samples;
    }
  }
  std::transform(expected.begin(), expected.end(), map.expected_samples.begin(), saturated);
  return map;
}

}  // namespace

std::int32_t frames_in_group(const AccumulateSettings& settings) {
  const std::int32_t wanted = settings.hold > 0 ? settings.hold : (settings.window + 1) / 3;
  return std::clamp(wanted, 1, settings.window + 1);
}

ShownAtRest shown_at_rest(std::int64_t frame, std::int64_t end, const AccumulateSettings& settings) {
  const std::int64_t window = settings.window;
  const std::int64_t group = frames_in_group(settings);
  const std::int64_t since_first = frame - 1;
  const std::int64_t place = (since_first % group + group) % group;
  const std::int64_t first = frame - place;
  return {std::min(first + group - 1, end) - window, first + window};
}

bool same_sites(const SamplingMap& a, const SamplingMap& b) {
  const auto same = [](const Site& x, const Site& y) {
    return x.block_x == y.block_x && x.block_y == y.block_y && x.pixels == y.pixels && x.region == y.region;
  };
  const auto same_blocks = [](const MapRegion& x, const MapRegion& y) { return x.block_px == y.block_px; };
  return a.width_px == b.width_px && a.height_px == b.height_px &&
         a.expected_samples.empty() == b.expected_samples.empty() &&
         std::equal(a.regions.begin(), a.regions.end(), b.regions.begin(), b.regions.end(), same_blocks) &&
         std::equal(a.sites.begin(), a.sites.end(), b.sites.begin(), b.sites.end(), same) && a.region == b.region;
}

SamplesAtRest add_up(const std::vector<SamplesOfFrame>& frames, const GuideCamera* camera, int threads) {
  const SparseFrame& first = *frames.front().sparse;
  const std::size_t sites = first.sum.size();
  SamplesAtRest all;
  all.map = map_of_all(frames);
  SparseFrame& out = all.sparse;
  out.width_px = first.width_px;
  out.height_px = first.height_px;
  out.sum.resize(sites);
  out.sum_square_luminance.resize(sites);
  out.count.resize(sites);
  out.guides.resize(first.guides.size());
  out.light_groups.resize(first.light_groups.size());
  out.half_difference.resize(first.half_difference.size());
  out.first_half.resize(first.first_half.size());
  out.first_surface.resize(first.first_surface.size());
  out.first_hits.resize(first.first_hits.size());
  std::vector<std::vector<SurfaceSums>> surfaces(all.map.tiles.size());
  parallel_for(all.map.tiles.size(), threads, [&](std::size_t t) {
    const MapTile& tile = all.map.tiles[t];
    SiteAdder adder(frames, camera, out);
    for (std::size_t site = tile.first_site; site < tile.first_site + tile.site_count; ++site) {
      adder.add_site(site, surfaces[t]);
    }
  });
  join_surfaces(std::move(surfaces), out);
  return all;
}

}  // namespace gazetrace
