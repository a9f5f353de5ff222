// SPDX-License-Identifier: Apache-2.0
// From sums per site to a dense frame.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// Dense and finite. AOV images are empty unless the SparseFrame holds guides.
struct Frame {
  ImageRgb radiance;        // linear Rec.709
  ImageGray sample_count;   // effective samples behind a pixel: site samples / site pixels, plus what accumulation adds
  ImageGray variance;       // of the pixel's mean luminance, from the samples' spread; 0 for a single sample
  ImageRgb albedo, normal;  // first hit, means over all samples; normal in world space, zero where nothing was hit
  ImageGray depth_m;        // mean over the hits; +Inf where the pixel's site hit nothing
};

struct FilterInfo {
  std::string name;  // "none": constant over a site's pixels. "linear": bilinear between sites' centroids
  std::string description;
  bool needs_guides = false;  // and samples traced with TraceSettings::surfaces
};
std::vector<FilterInfo> reconstruction_filters();
bool filter_needs_guides(const std::string& filter);  // false for unknown names

// A site without samples takes its value from its neighbours; pixels of a 1x1 site pass through bit-equal.
// "guided" changes the sites that needs_filtering() names and no others. `guides`: of the map's size; nullptr unless
// the filter needs them. Error(usage) for an unknown name, Error(runtime) for inputs that do not belong together.
Frame reconstruct(const SparseFrame& sparse, const SamplingMap& map, const std::string& filter, int threads = 0,
                  const Guides* guides = nullptr);

}  // namespace gazetrace
