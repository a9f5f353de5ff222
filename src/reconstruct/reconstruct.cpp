// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/reconstruct.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
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

void check_guides(const FilterInput& input) {
  if (input.guides == nullptr || input.sparse.first_surface.size() != input.map.sites.size() + 1) {
    throw Error(ErrorKind::runtime, "reconstruct", "the filter needs guides and sums per surface",
                "trace with TraceSettings::surfaces and pass PathTracer::guides");
  }
  if (input.guides->albedo.width_px != input.map.width_px || input.guides->albedo.height_px != input.map.height_px) {
    throw Error(ErrorKind::runtime, "reconstruct", "the guides are of another size than the sampling map",
                "make them for the map's frame");
  }
}

}  // namespace

std::vector<FilterInfo> reconstruction_filters() {
  return {
#define FILTER(name, needs_guides, description) {user_name(#name), description, needs_guides},
#include "reconstruct/filters.def"
#undef FILTER
  };
}

bool filter_needs_guides(const std::string& filter) {
  const std::vector<FilterInfo> filters = reconstruction_filters();
  return std::any_of(filters.begin(), filters.end(),
                     [&](const FilterInfo& info) { return info.name == filter && info.needs_guides; });
}

Frame reconstruct(const SparseFrame& sparse, const SamplingMap& map, const std::string& filter, int threads,
                  const Guides* guides) {
  const SiteValues values(sparse, map);
  const FilterInput input{sparse, values, map, guides, threads};
  if (filter_needs_guides(filter)) {
    check_guides(input);
  }
#define FILTER(name, needs_guides, description) \
  if (filter == user_name(#name)) {             \
    return filter_##name(input);                \
  }
#include "reconstruct/filters.def"
#undef FILTER
  std::vector<std::string> names;
  for (const FilterInfo& info : reconstruction_filters()) {
    names.push_back(info.name);
  }
  throw Error(ErrorKind::usage, "filter", unknown_name_message("reconstruction filter", filter, names));
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
