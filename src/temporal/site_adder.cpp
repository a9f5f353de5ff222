// SPDX-License-Identifier: Apache-2.0
#include "temporal/site_adder.hpp"

#include <algorithm>
#include <cmath>

#include "core/luminance.hpp"

namespace gazetrace {
namespace {

std::uint8_t half_of(const JoiningFrame& frame) {
  return static_cast<std::uint8_t>(frame.scrambling & 1);
}

}  // namespace

SiteAdder::SiteAdder(const CameraRays& rays, SamplingMap& map, SparseFrame& out)
    : map_(map),
      out_(out),
      sorters_(kBatchSites, SurfaceSorter(std::sqrt(dot(rays.placement().up_step, rays.placement().up_step)),
                                          rays.is_perspective())) {}

void SiteAdder::add(std::size_t first, std::size_t count, std::span<const JoiningFrame> frames,
                    std::vector<SurfaceSums>& surfaces) {
  start(count, frames);
  for (const JoiningFrame& frame : frames) {
    add_sums(frame);
    add_surfaces(frame);
    if (!out_.guides.empty()) {
      add_guides(frame);
    }
    if (!out_.light_groups.empty()) {
      add_light_groups(frame);
    }
    if (!out_.first_hits.empty()) {
      add_first_hits(frame);
    }
  }
  if (std::any_of(sums_.begin(), sums_.end(), [](const Sums& sums) { return !sums.by_frames(); })) {
    within_.assign(count, {});
    for (const JoiningFrame& frame : frames) {
      add_within_frames(frame);
    }
  }
  for (std::size_t at = 0; at < count; ++at) {
    finish(first + at, at, surfaces);
  }
}

void SiteAdder::start(std::size_t count, std::span<const JoiningFrame> frames) {
  sums_.assign(count, {});
  guides_.assign(out_.guides.empty() ? 0 : count, {});
  light_groups_.assign(out_.light_groups.empty() ? 0 : count, {});
  first_hits_.assign(out_.first_hits.empty() ? 0 : count, {});
  for (const JoiningFrame& frame : frames) {
    for (const Joining& one : frame.joining) {
      Sums& sums = sums_[one.to];
      ++sums.sites;
      sums.last = frame.sparse;
      sums.last_site = one.site;
    }
  }
}

void SiteAdder::add_sums(const JoiningFrame& frame) {
  const SparseFrame& from = *frame.sparse;
  const std::uint8_t half = half_of(frame);
  for (const Joining& one : frame.joining) {
    Sums& to = sums_[one.to];
    const Vec3d light = to_double(from.sum[one.site]);
    to.light += light;
    if (half == 0) {
      to.light_of_first_half += light;
    }
    to.square += static_cast<double>(from.sum_square_luminance[one.site]);
    to.bright[half] += luminance(light);
    to.count[half] += from.count[one.site];
    to.planned += frame.map->sites[one.site].samples;
    to.expected += frame.map->expected(one.site);
  }
}

void SiteAdder::add_surfaces(const JoiningFrame& frame) {
  const SparseFrame& from = *frame.sparse;
  const std::uint8_t half = half_of(frame);
  for (const Joining& one : frame.joining) {
    if (sums_[one.to].sites == 1) {
      continue;  // it keeps its surfaces as they are
    }
    const Vec3f moved_m = frame.moved_m.empty() ? frame.camera_m : frame.moved_m[one.site];
    for (std::size_t s = from.first_surface[one.site]; s < from.first_surface[one.site + 1]; ++s) {
      SurfaceSums surface = from.surfaces[s];
      surface.position_m += static_cast<float>(surface.count) * moved_m;
      sorters_[one.to].add(surface, half);
    }
  }
}

void SiteAdder::add_guides(const JoiningFrame& frame) {
  for (const Joining& one : frame.joining) {
    const GuideSums& from = frame.sparse->guides[one.site];
    GuideDoubles& to = guides_[one.to];
    to.albedo += to_double(from.albedo);
    to.normal += to_double(from.normal);
    to.hits += from.hits;
  }
}

void SiteAdder::add_light_groups(const JoiningFrame& frame) {
  for (const Joining& one : frame.joining) {
    for (std::size_t group = 0; group < kLightGroups; ++group) {
      light_groups_[one.to][group] += to_double(frame.sparse->light_groups[one.site].sum[group]);
    }
  }
}

void SiteAdder::add_first_hits(const JoiningFrame& frame) {
  for (const Joining& one : frame.joining) {
    const FirstHitSums& from = frame.sparse->first_hits[one.site];
    FirstHitDoubles& to = first_hits_[one.to];
    const Vec3d shone = to_double(from.shone);
    to.shone += shone;
    to.bright[half_of(frame)] += luminance(shone);
    to.square_shift += static_cast<double>(from.square_shift_px2);
    to.blended += from.blended;
  }
}

void SiteAdder::add_within_frames(const JoiningFrame& frame) {
  const SparseFrame& from = *frame.sparse;
  for (const Joining& one : frame.joining) {
    if (sums_[one.to].by_frames()) {
      continue;
    }
    WithinFrames& to = within_[one.to];
    const double behind = from.count[one.site];
    to.samples += behind;
    if (!out_.half_difference.empty()) {
      to.light += static_cast<double>(from.half_difference[one.site]) * behind;
    }
    if (!out_.first_hits.empty()) {
      to.shone += static_cast<double>(from.first_hits[one.site].shone_difference) * behind;
    }
    if (!out_.first_half.empty()) {
      to.first_half += to_double(from.first_half[one.site].radiance);
      to.first_half_samples += from.first_half[one.site].count;
    }
  }
}

void SiteAdder::finish(std::size_t site, std::size_t at, std::vector<SurfaceSums>& surfaces) {
  const Sums& sums = sums_[at];
  map_.sites[site].samples = sums.planned;
  if (!map_.expected_samples.empty()) {
    map_.expected_samples[site] = saturated(sums.expected);
  }
  out_.sum[site] = to_float(sums.light);
  out_.sum_square_luminance[site] = saturated(sums.square);
  out_.count[site] = sums.count[0] + sums.count[1];
  const auto difference = [&](const std::array<double, 2>& bright, double WithinFrames::*within) {
    if (sums.by_frames()) {
      return half_difference(bright, sums.count);
    }
    return within_[at].samples > 0 ? static_cast<float>(within_[at].*within / within_[at].samples) : 0;
  };
  if (!out_.half_difference.empty()) {
    out_.half_difference[site] = difference(sums.bright, &WithinFrames::light);
  }
  if (!out_.first_half.empty()) {
    out_.first_half[site] = sums.by_frames()
                                ? HalfSum{to_float(sums.light_of_first_half), sums.count[0]}
                                : HalfSum{to_float(within_[at].first_half), within_[at].first_half_samples};
  }
  if (!out_.guides.empty()) {
    GuideSums& to = out_.guides[site];
    const GuideDoubles& from = guides_[at];
    to.albedo = to_float(from.albedo);
    to.normal = to_float(from.normal);
    // Depths of other views are others: that of the frame itself stands for all.
    to.depth_m = to.hits > 0 ? to.depth_m / static_cast<float>(to.hits) * static_cast<float>(from.hits) : 0;
    to.hits = to.hits > 0 ? from.hits : 0;
  }
  if (!out_.light_groups.empty()) {
    std::transform(light_groups_[at].begin(), light_groups_[at].end(), out_.light_groups[site].sum.begin(),
                   [](const Vec3d& light) { return to_float(light); });
  }
  if (!out_.first_hits.empty()) {
    const FirstHitDoubles& from = first_hits_[at];
    out_.first_hits[site] = {to_float(from.shone), difference(from.bright, &WithinFrames::shone),
                             saturated(from.square_shift), from.blended};
  }
  const std::size_t before = surfaces.size();
  if (sums.sites == 1) {
    const SparseFrame& own = *sums.last;
    surfaces.insert(surfaces.end(), own.surfaces.begin() + own.first_surface[sums.last_site],
                    own.surfaces.begin() + own.first_surface[sums.last_site + 1]);
  } else {
    sorters_[at].finish_site(out_.first_hits.empty() ? std::array<std::uint32_t, 2>{} : sums.count, surfaces);
  }
  out_.first_surface[site] = static_cast<std::uint32_t>(surfaces.size() - before);
}

}  // namespace gazetrace
