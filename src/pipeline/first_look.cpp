// SPDX-License-Identifier: Apache-2.0
// After the idea of Stengel et al. 2016 ("Adaptive image-space sampling for gaze-contingent real-time rendering") and
// Tursun et al. 2019 ("Luminance-contrast-aware foveated rendering") that a picture without contrast needs less detail.
// The shape and the constants of the multiplier are choices made here, since the models of both papers need the picture
// at full resolution.
#include "pipeline/first_look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/hash.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr int kReduction = 8;
constexpr std::uint32_t kSpp = 4;
constexpr std::uint64_t kFirstLookTag = 0x434f4e5452415354ULL;
constexpr double kFullContrast = 0.25;
constexpr double kMostTaken = 0.75;

struct Luminance {
  double mean = 0, variance_of_mean = 0;
};

Luminance luminance_of(const SparseFrame& sparse, std::size_t site) {
  const double n = sparse.count[site];
  if (n == 0) {
    return {};
  }
  const Vec3d sum = to_double(sparse.sum[site]);
  const double mean = (0.2126 * sum.x + 0.7152 * sum.y + 0.0722 * sum.z) / n;
  const double square = static_cast<double>(sparse.sum_square_luminance[site]) / n;
  return {mean, n > 1 ? std::max(0.0, square - mean * mean) / (n - 1) : 0.0};
}

// It pictures the same as the frame does, since a frame's rays follow from its height and the camera's field of view.
PlanarView small_view(const FrameRequest& request) {
  PlanarView view = request.view;
  view.height_px = (request.height_px + kReduction - 1) / kReduction;
  const double aspect = static_cast<double>(request.width_px) / request.height_px;
  view.width_px = std::max(1, static_cast<int>(std::lround(view.height_px * aspect)));
  return view;
}

}  // namespace

ImageGray local_contrast(const SparseFrame& sparse, const SamplingMap& map) {
  Image<std::size_t> site_at(map.width_px, map.height_px);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    site_at(map.sites[i].block_x, map.sites[i].block_y) = i;
  }
  ImageGray contrast(map.width_px, map.height_px);
  for (int y = 0; y < map.height_px; ++y) {
    for (int x = 0; x < map.width_px; ++x) {
      double sum = 0;
      double square = 0;
      double noise = 0;
      int count = 0;
      for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, map.height_px - 1); ++ny) {
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, map.width_px - 1); ++nx) {
          const Luminance here = luminance_of(sparse, site_at(nx, ny));
          sum += here.mean;
          square += here.mean * here.mean;
          noise += here.variance_of_mean;
          ++count;
        }
      }
      const double mean = sum / count;
      const double spread = count > 1 ? (square - sum * mean) / (count - 1) : 0.0;
      const double seen = std::max(0.0, spread - noise / count);
      contrast(x, y) = mean > 0 ? static_cast<float>(std::sqrt(seen) / mean) : 0.0F;
    }
  }
  return contrast;
}

ImageGray contrast_multiplier(const ImageGray& contrast, double strength) {
  ImageGray multiplier = contrast;
  for (float& value : multiplier.pixels) {
    const double part = std::min(1.0, static_cast<double>(value) / kFullContrast);
    value = static_cast<float>(1 - kMostTaken * strength * (1 - part));
  }
  return multiplier;
}

FoveationSettings less_first_look(const FoveationSettings& settings, const FrameRequest& request) {
  const bool in_all = settings.budget_samples.has_value();
  if (!in_all && !settings.budget_spp) {
    return settings;
  }
  const PlanarView view = small_view(request);
  const std::uint64_t taken =
      std::uint64_t{kSpp} * static_cast<std::uint64_t>(view.width_px) * static_cast<std::uint64_t>(view.height_px);
  const double pixels = static_cast<double>(request.width_px) * request.height_px;
  const double budget = in_all ? static_cast<double>(*settings.budget_samples) : *settings.budget_spp * pixels;
  if (!(budget > static_cast<double>(taken))) {
    throw Error(ErrorKind::usage, in_all ? "`budget-samples`" : "`budget-spp`",
                fmt::format("the first look of `contrast-strength` takes {} samples of a frame of {} x {} pixels, the "
                            "budget is {:.0f}",
                            taken, request.width_px, request.height_px, budget),
                "give more, or leave out `contrast-strength`");
  }
  FoveationSettings rest = settings;
  if (in_all) {
    *rest.budget_samples -= taken;
  } else {
    rest.budget_spp = (budget - static_cast<double>(taken)) / pixels;
  }
  return rest;
}

FirstLook trace_first_look(const PosedScene& scene, const FrameRequest& request, const TraceSettings& settings,
                           double strength) {
  FoveationSettings uniform;
  uniform.uniform_spp = kSpp;
  const SamplingMap map = make_sampling_map(uniform, small_view(request), std::nullopt);
  TraceSettings own = settings;
  own.seed = hash_combine(settings.seed, kFirstLookTag);
  own.guides = false;
  own.surfaces = false;
  own.only_pixel.reset();
  SparseFrame sparse = scene.trace(request.camera, request.frame, map, own);
  return {contrast_multiplier(local_contrast(sparse, map), strength), std::move(sparse.stats)};
}

}  // namespace gazetrace
