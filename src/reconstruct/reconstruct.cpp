// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/reconstruct.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "reconstruct/filter.hpp"

namespace gazetrace {

namespace {

// As users write it.
std::string user_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

struct NamedFilter {
  std::string name;
  const FilterDefinition* definition;
  std::string description;
};

std::vector<NamedFilter> named_filters() {
  return {
#define FILTER(name, description) {user_name(#name), &filter_##name, description},
#include "reconstruct/filters.def"
#undef FILTER
  };
}

NamedFilter filter_named(const std::string& name) {
  if (name.empty()) {
    throw Error(ErrorKind::usage, "filter", "no reconstruction filter is named",
                "name one of reconstruction_filters(), most often the one that choose_filter() chooses");
  }
  const std::vector<NamedFilter> filters = named_filters();
  const auto found = std::find_if(filters.begin(), filters.end(), [&](const auto& f) { return f.name == name; });
  if (found == filters.end()) {
    std::vector<std::string> names;
    for (const NamedFilter& filter : filters) {
      names.push_back(filter.name);
    }
    throw Error(ErrorKind::usage, "filter", unknown_name_message("reconstruction filter", name, names));
  }
  return *found;
}

FilterInfo info_of(const NamedFilter& filter) {
  return {filter.name, filter.description, filter.definition->needs};
}

void check_needs(const ReconstructionNeeds& needs, const SparseFrame& sparse, const SamplingMap& map,
                 const Guides* guides) {
  if ((needs.guides && guides == nullptr) || (needs.surfaces && sparse.first_surface.size() != map.sites.size() + 1) ||
      (needs.halves && sparse.half_difference.size() != map.sites.size()) ||
      (needs.first_half && sparse.first_half.size() != map.sites.size())) {
    throw Error(ErrorKind::runtime, "reconstruct", "the filter needs guides, sums per surface and halves",
                "trace with Reconstruction::trace_settings and pass guides of Reconstruction::guide_settings");
  }
  if (needs.guides && (guides->albedo.width_px != map.width_px || guides->albedo.height_px != map.height_px)) {
    throw Error(ErrorKind::runtime, "reconstruct", "the guides are of another size than the sampling map",
                "make them for the map's frame");
  }
}

}  // namespace

std::vector<FilterInfo> reconstruction_filters() {
  std::vector<FilterInfo> filters;
  for (const NamedFilter& filter : named_filters()) {
    filters.push_back(info_of(filter));
  }
  return filters;
}

Reconstruction::Reconstruction(const ReconstructionSettings& settings) {
  const NamedFilter named = filter_named(settings.filter);
  definition_ = named.definition;
  filter_ = info_of(named);
}

TraceSettings Reconstruction::trace_settings(TraceSettings settings, const SamplingMap* map) const {
  settings.surfaces = filter_.needs.surfaces;
  settings.halves = filter_.needs.halves;
  settings.first_half = filter_.needs.first_half;
  const auto& needs_independent = definition_->needs_independent_halves;
  settings.independent_halves = map == nullptr || needs_independent == nullptr || needs_independent(*map);
  return settings;
}

std::optional<GuideSettings> Reconstruction::guide_settings(const TraceSettings& trace, bool joins) const {
  std::optional<GuideSettings> settings = filter_.needs.guides;
  if (settings) {
    settings->diffuse = trace.diffuse;
    settings->spp = joins ? 1 : settings->spp;
  }
  return settings;
}

Frame Reconstruction::frame(const SparseFrame& sparse, const SamplingMap& map, const Guides* guides,
                            int threads) const {
  const SiteValues values(sparse, map, threads);
  check_needs(filter_.needs, sparse, map, guides);
  return definition_->frame({sparse, values, map, guides, threads});
}

Frame make_frame(const SamplingMap& map, bool guides) {
  const int w = map.width_px;
  const int h = map.height_px;
  Frame frame;
  frame.radiance = ImageRgb(w, h);
  frame.sample_count = ImageGray(w, h);
  frame.variance = ImageGray(w, h);
  if (guides) {
    frame.albedo = ImageRgb(w, h);
    frame.normal = ImageRgb(w, h);
    frame.depth_m = ImageGray(w, h, std::numeric_limits<float>::infinity());
  }
  return frame;
}

void paint_site(Frame& frame, const SamplingMap& map, const SiteValues& values, std::size_t site) {
  const SiteValue value = values.value(site);
  const float density = static_cast<float>(values.count(site)) / static_cast<float>(map.sites[site].pixels);
  for_each_pixel(map, map.sites[site], [&](int x, int y) {
    const std::size_t i = frame.radiance.index(x, y);
    frame.radiance.pixels[i] = value.radiance;
    frame.variance.pixels[i] = value.variance;
    frame.sample_count.pixels[i] = density;
  });
  if (values.has_guides()) {
    const SiteGuides guides = values.guides(site);
    for_each_pixel(map, map.sites[site], [&](int x, int y) {
      const std::size_t i = frame.radiance.index(x, y);
      frame.albedo.pixels[i] = guides.albedo;
      frame.normal.pixels[i] = guides.normal;
      frame.depth_m.pixels[i] = guides.depth_m;
    });
  }
}

}  // namespace gazetrace
