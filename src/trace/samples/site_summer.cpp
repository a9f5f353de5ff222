// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/site_summer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/luminance.hpp"
#include "trace/samples/bad_samples.hpp"

namespace gazetrace {
namespace {

constexpr double kMostSquare = std::numeric_limits<float>::max();

void add_guides(const GuideBatch& g, std::size_t i, SiteGuideSums& sums) {
  sums.albedo += Vec3d{g.albedo_r[i], g.albedo_g[i], g.albedo_b[i]};
  sums.normal += Vec3d{g.normal_x[i], g.normal_y[i], g.normal_z[i]};
  sums.depth_m += static_cast<double>(g.depth[i]);
  ++sums.hits;
}

void add_light(const Vec3f& radiance, SiteLightSums& sums) {
  sums.radiance += to_double(radiance);
  const double shone = luminance(to_double(radiance));
  // A float, as the radiance is. It saturates, since squares exceed float's range from a radiance of 1.8e19 on.
  sums.square_luminance += static_cast<double>(static_cast<float>(std::min(shone * shone, kMostSquare)));
}

void add_groups(const LightGroupBatch& batch, std::size_t i, std::array<Vec3d, kLightGroups>& sums) {
  for (std::size_t group = 0; group < kLightGroups; ++group) {
    sums[group] += to_double(batch.radiance[group].get(i));
  }
}

SurfaceSorter sorter_for(const CameraRays& camera) {
  const Vec3f& step = camera.placement().up_step;
  return {std::sqrt(dot(step, step)), camera.is_perspective()};
}

}  // namespace

SiteSummer::SiteSummer(const FrameContext& context, std::int32_t frame, std::uint32_t first_site, SparseFrame& out)
    : frame_(frame),
      surfaces_(context.settings.surfaces),
      out_(out),
      site_(first_site),
      sorter_(sorter_for(*context.camera)) {}

void SiteSummer::add(const Workspace& work, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (work.samples.site[i] != site_) {
      finish_site();
      site_ = work.samples.site[i];
    }
    ++sum_.light.count;
    if (work.radiance.rejected[i] != 0) {
      report(work.samples, i, "rejected ray");
    }
    if (!out_.guides.empty() && work.guides.hit[i] != 0) {
      add_guides(work.guides, i, sum_.guides);
    }
    const Vec3f radiance{work.radiance.r[i], work.radiance.g[i], work.radiance.b[i]};
    if (!is_finite(radiance)) {
      ++range_.non_finite;
      report(work.samples, i, "non-finite radiance");
      continue;
    }
    add_light(radiance, sum_.light);
    if (!out_.light_groups.empty()) {
      add_groups(work.groups, i, sum_.groups);
    }
    halves_.add(luminance(to_double(radiance)), work.samples.half[i]);
    if (work.samples.half[i] == 0) {
      sum_.light.first_half += to_double(radiance);
    }
    if (surfaces_) {
      sorter_.add(work.surfaces, i, to_double(radiance), work.samples.half[i]);
      if (!out_.first_hits.empty()) {
        first_hits_.add(work.surfaces, i, work.samples.half[i]);
      }
    }
  }
}

SummedRange SiteSummer::finish() {
  if (sum_.light.count > 0) {
    finish_site();
  }
  return std::move(range_);
}

void SiteSummer::finish_site() {
  if (!is_finite(to_float(sum_.light.radiance))) {  // of samples that are, each by itself
    range_.non_finite += sum_.light.count;
    sum_.light.radiance = sum_.light.first_half = {};
    sum_.groups = {};
  }
  out_.sum[site_] = to_float(sum_.light.radiance);
  out_.sum_square_luminance[site_] = static_cast<float>(std::min(sum_.light.square_luminance, kMostSquare));
  out_.count[site_] = sum_.light.count;
  if (!out_.guides.empty()) {
    const SiteGuideSums& guides = sum_.guides;
    out_.guides[site_] = {to_float(guides.albedo), to_float(guides.normal), static_cast<float>(guides.depth_m),
                          guides.hits};
  }
  for (std::size_t group = 0; group < kLightGroups && !out_.light_groups.empty(); ++group) {
    out_.light_groups[site_].sum[group] = to_float(sum_.groups[group]);
  }
  if (!out_.first_half.empty()) {
    out_.first_half[site_] = {to_float(sum_.light.first_half), halves_.count[0]};
  }
  sum_ = {};
  if (!out_.half_difference.empty()) {
    out_.half_difference[site_] = halves_.difference();
  }
  halves_ = {};
  if (surfaces_) {
    const std::size_t before = range_.surfaces.size();
    sorter_.finish_site(first_hits_.samples(), range_.surfaces);
    out_.first_surface[site_] = static_cast<std::uint32_t>(range_.surfaces.size() - before);
  }
  if (!out_.first_hits.empty()) {
    out_.first_hits[site_] = first_hits_.finish_site();
  }
}

void SiteSummer::report(const SampleBatch& samples, std::size_t slot, const char* what) {
  keep_first(range_.bad, {frame_, samples.pixel_x[slot], samples.pixel_y[slot], samples.sample[slot], what});
}

}  // namespace gazetrace
