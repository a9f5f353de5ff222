// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/sample_sums.hpp"

#include <algorithm>
#include <limits>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

void add(const SiteSums& from, SiteSums& to) {
  to.red.add(from.red);
  to.green.add(from.green);
  to.blue.add(from.blue);
  to.square_luminance.add(from.square_luminance);
  to.count += from.count;
}

void add(const SiteGuideSums& from, SiteGuideSums& to) {
  to.albedo_red.add(from.albedo_red);
  to.albedo_green.add(from.albedo_green);
  to.albedo_blue.add(from.albedo_blue);
  to.normal_x.add(from.normal_x);
  to.normal_y.add(from.normal_y);
  to.normal_z.add(from.normal_z);
  to.depth_m.add(from.depth_m);
  to.hits += from.hits;
}

}  // namespace

void store_rounded(const SiteSums& sums, const SiteGuideSums* guides, std::size_t site, SparseFrame& out) {
  out.sum[site] = {sums.red.value(), sums.green.value(), sums.blue.value()};
  out.sum_square_luminance[site] = std::min(sums.square_luminance.value(), std::numeric_limits<float>::max());
  out.count[site] = static_cast<std::uint32_t>(sums.count);
  if (guides != nullptr) {
    out.guides[site] = {{guides->albedo_red.value(), guides->albedo_green.value(), guides->albedo_blue.value()},
                        {guides->normal_x.value(), guides->normal_y.value(), guides->normal_z.value()},
                        guides->depth_m.value(),
                        static_cast<std::uint32_t>(guides->hits)};
  }
}

void add_sums(const SampleSums& from, SampleSums& to) {
  if (from.sites.size() != to.sites.size() || from.guides.size() != to.guides.size()) {
    throw Error(ErrorKind::runtime, "samples", "sums of different sampling maps cannot be added");
  }
  for (std::size_t i = 0; i < to.sites.size(); ++i) {
    add(from.sites[i], to.sites[i]);
  }
  for (std::size_t i = 0; i < to.guides.size(); ++i) {
    add(from.guides[i], to.guides[i]);
  }
}

SparseFrame empty_frame(const SamplingMap& map, bool guides) {
  const std::size_t sites = map.sites.size();
  SparseFrame out;
  out.width_px = map.width_px;
  out.height_px = map.height_px;
  out.sum.resize(sites);
  out.sum_square_luminance.resize(sites);
  out.count.resize(sites);
  out.guides.resize(guides ? sites : 0);
  return out;
}

SparseFrame sparse_frame_of(const SampleSums& sums, const SamplingMap& map) {
  const std::size_t sites = map.sites.size();
  const bool guides = !sums.guides.empty();
  if (sums.sites.size() != sites || (guides && sums.guides.size() != sites)) {
    throw Error(ErrorKind::runtime, "samples", "the sums were not traced with this sampling map");
  }
  SparseFrame out = empty_frame(map, guides);
  for (std::size_t i = 0; i < sites; ++i) {
    store_rounded(sums.sites[i], guides ? &sums.guides[i] : nullptr, i, out);
  }
  return out;
}

}  // namespace gazetrace
