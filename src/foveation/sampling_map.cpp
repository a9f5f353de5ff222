// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>

#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {
namespace {

constexpr int kMaxFramePx = 65535;  // blocks and pixels are counted in 16 bits

void check_view(const PlanarView& view) {
  if (view.width_px < 1 || view.height_px < 1 || view.width_px > kMaxFramePx || view.height_px > kMaxFramePx) {
    throw Error(ErrorKind::usage, "frame size",
                std::to_string(view.width_px) + " x " + std::to_string(view.height_px) + " pixels are not possible",
                "give 1 to " + std::to_string(kMaxFramePx) + " for each side");
  }
}

void check_gaze(const Vec3d& direction) {
  const double len = length(direction);
  if (!std::isfinite(len) || !(len > 0)) {
    throw Error(ErrorKind::usage, "gaze direction", "it is zero or not finite",
                "leave it empty for a frame without gaze");
  }
}

Layout make_layout(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction) {
#define FALLOFF(name, description)                        \
  if (settings.falloff == #name) {                        \
    return layout_##name(settings, view, gaze_direction); \
  }
#include "foveation/falloffs.def"
#undef FALLOFF
  return {};  // not reached: check_foveation knows the same list
}

}  // namespace

std::uint64_t SamplingMap::samples() const {
  std::uint64_t sum = 0;
  for (const MapRegion& r : regions) {
    sum += r.samples;
  }
  return sum;
}

SamplingMap make_sampling_map(const FoveationSettings& settings, const PlanarView& view,
                              const std::optional<Vec3d>& gaze_direction) {
  check_foveation(settings);
  check_view(view);
  if (!gaze_direction) {
    return map_from_layout(uniform_layout(settings.uniform_spp, view.width_px, view.height_px));
  }
  check_gaze(*gaze_direction);
  return map_from_layout(make_layout(settings, view, *gaze_direction));
}

void pixels_of_site(const SamplingMap& map, const Site& site, std::vector<PixelIndex>& out) {
  out.clear();
  for_each_pixel(map, site, [&](int x, int y) {
    out.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  });
}

ImageGray samples_per_pixel(const SamplingMap& map) {
  ImageGray image(map.width_px, map.height_px);
  for (const Site& site : map.sites) {
    const auto value = static_cast<float>(static_cast<double>(site.samples) / site.pixels);
    for_each_pixel(map, site, [&](int x, int y) { image(x, y) = value; });
  }
  return image;
}

ImageGray eccentricity_image(const PlanarView& view, const Vec3d& gaze_direction) {
  ImageGray image(view.width_px, view.height_px);
  for (int y = 0; y < view.height_px; ++y) {
    for (int x = 0; x < view.width_px; ++x) {
      image(x, y) = static_cast<float>(eccentricity_deg(view, gaze_direction, x + 0.5, y + 0.5));
    }
  }
  return image;
}

}  // namespace gazetrace
