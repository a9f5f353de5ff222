// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/parallel.hpp"
#include "foveation/blocks.hpp"
#include "foveation/picture.hpp"
#include "foveation/sites.hpp"
#include "foveation/whole_counts.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {
namespace {

constexpr int kMaxFramePx = 65535;  // blocks and pixels are counted in 16 bits
constexpr double kMaxSpp = 1e6;     // times 64 x 64 pixels of a block still fits 32 bits

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

void require_picture(const DensityModel& model, const FoveationSettings& settings, const MapContext& context) {
  if (!model.from_picture) {
    return;
  }
  if (context.density == nullptr) {
    throw Error(ErrorKind::usage, "`sampling`",
                "'" + to_string(settings.sampling) + "' follows a picture, and there is none",
                "give MapContext::density");
  }
  check_density_picture(*context.density, settings, "density picture");
}

// The samples of the frame, where they are stated.
std::optional<double> budget_of(const FoveationSettings& settings, const PlanarView& view) {
  return settings.spp ? std::optional(*settings.spp * view.width_px * view.height_px) : std::nullopt;
}

SamplingMap map_of_layout(Layout layout, const std::optional<double>& budget, const MapContext& context) {
  SamplingMap map = map_from_layout(std::move(layout));
  if (budget) {
    std::vector<double> weights(map.sites.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
      weights[i] = map.sites[i].samples;
    }
    const double scale = rate_of_budget(map, weights, *budget, kMaxSpp);
    set_whole_counts(map, weights, scale, kMaxSpp, context.seed, context.frame);
  }
  return map;
}

SamplingMap map_of_density(DensityModel model, const FoveationSettings& asked, const PlanarView& view,
                           const Vec3d& gaze_direction, const std::optional<double>& budget,
                           const MapContext& context) {
  require_picture(model, asked, context);
  if (model.from_picture) {
    model.full_rate_spp = full_rate_of_picture(context);
  }
  double rate = model.full_rate_spp;
  FoveationSettings settings = asked;
  if (model.own_block_samples && asked.block_samples == FoveationSettings().block_samples) {
    settings.block_samples = *model.own_block_samples;
  }
  const DensityField field(view, gaze_direction, context, std::move(model));
  if (budget) {
    rate = std::min(*budget / sum_of_density(field, view.width_px, view.height_px, context.threads), kMaxSpp);
  }
  WeighedMap blocks = blocks_of_density(field, settings, view.width_px, view.height_px, rate, context.threads);
  if (budget) {
    rate = rate_of_budget(blocks.map, blocks.weights, *budget, kMaxSpp);
  }
  set_whole_counts(blocks.map, blocks.weights, rate, kMaxSpp, context.seed, context.frame);
  return std::move(blocks.map);
}

SamplingMap uniform_map(const FoveationSettings& settings, const PlanarView& view, const MapContext& context) {
  const double spp = settings.spp.value_or(kUsualSpp);
  const bool is_whole = spp == std::floor(spp);
  const auto samples = static_cast<std::uint32_t>(is_whole ? spp : kUsualSpp);
  return map_of_layout(uniform_layout(samples, view.width_px, view.height_px),
                       is_whole ? std::nullopt : budget_of(settings, view), context);
}

SamplingMap map_of_sampling(const FoveationSettings& settings, const PlanarView& view,
                            const std::optional<Vec3d>& gaze_direction, const MapContext& context) {
  if (gaze_direction) {
    check_gaze(*gaze_direction);
  }
  if (is_uniform(settings.sampling) || (!gaze_direction && traits_of(settings.sampling).needs_gaze)) {
    return uniform_map(settings, view, context);
  }
  const std::optional<double> budget = budget_of(settings, view);
  const Vec3d gaze = gaze_direction.value_or(view.direction(0.5 * view.width_px, 0.5 * view.height_px));
  SamplingModel sampling = sampling_model(settings, view, gaze);
  if (auto* model = std::get_if<DensityModel>(&sampling)) {
    return map_of_density(std::move(*model), settings, view, gaze, budget, context);
  }
  return map_of_layout(std::get<Layout>(std::move(sampling)), budget, context);
}

}  // namespace

void check_density_picture(const ImageGray& density, const FoveationSettings& settings, const std::string& place) {
  const double most = settings.spp ? std::numeric_limits<float>::max() : kMaxSpp;
  bool any = false;
  for (std::size_t i = 0; i < density.pixels.size(); ++i) {
    const auto value = static_cast<double>(density.pixels[i]);
    if (!(value >= 0 && value <= most)) {
      const auto width = static_cast<std::size_t>(density.width_px);
      throw Error(ErrorKind::input, place, fmt::format("pixel {},{} has the value {}", i % width, i / width, value),
                  fmt::format("give 0 to {:g}{}", most, most == kMaxSpp ? " samples a pixel" : ""));
    }
    any = any || value > 0;
  }
  if (!any) {
    throw Error(ErrorKind::input, place, density.empty() ? "it has no pixels" : "no pixel has a value above 0",
                "it says where the samples go");
  }
}

std::uint64_t SamplingMap::samples() const {
  std::uint64_t sum = 0;
  for (const MapRegion& r : regions) {
    sum += r.samples;
  }
  return sum;
}

SamplingMap make_sampling_map(const FoveationSettings& settings, const PlanarView& view,
                              const std::optional<Vec3d>& gaze_direction, const MapContext& context) {
  check_foveation(settings);
  check_view(view);
  return map_of_sampling(settings, view, gaze_direction, context);
}

std::optional<ImageGray> density_image(const FoveationSettings& settings, const PlanarView& view,
                                       const Vec3d& gaze_direction, const MapContext& context) {
  check_foveation(settings);
  check_view(view);
  check_gaze(gaze_direction);
  SamplingModel sampling = sampling_model(settings, view, gaze_direction);
  auto* model = std::get_if<DensityModel>(&sampling);
  if (model == nullptr) {
    return std::nullopt;
  }
  require_picture(*model, settings, context);
  const DensityField field(view, gaze_direction, context, std::move(*model));
  ImageGray image(view.width_px, view.height_px);
  parallel_for(static_cast<std::size_t>(view.height_px), context.threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < view.width_px; ++x) {
      image(x, y) = static_cast<float>(field.at(x + 0.5, y + 0.5));
    }
  });
  return image;
}

void pixels_of_site(const SamplingMap& map, const Site& site, std::vector<PixelIndex>& out) {
  out.clear();
  for_each_pixel(map, site, [&](int x, int y) {
    out.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  });
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
