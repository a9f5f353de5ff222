// SPDX-License-Identifier: Apache-2.0
// Densities that come from outside: pictures that say where the samples of a frame go.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "core/image_io.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

ImageGray read_density_picture(const FoveationSettings& settings, std::int32_t frame) {
  const std::string files = picture_files_of(settings.sampling);
  if (files.empty()) {
    return {};
  }
  const std::string path = frame_file_name(files, frame);
  ImageGray density = read_picture_channel(path, {"Y", "samples_per_pixel", "R"});
  check_density_picture(density, settings, path);
  return density;
}

std::vector<std::string> density_picture_files(const FoveationSettings& settings) {
  const std::string pattern = picture_files_of(settings.sampling);
  std::vector<std::string> files;
  for (const std::int32_t frame : pattern.empty() ? std::vector<std::int32_t>() : find_frames(pattern)) {
    files.push_back(frame_file_name(pattern, frame));
  }
  return files;
}

SamplingMap planned_sampling_map(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                                 int threads) {
  MapContext context = map_context(request, seed, threads);
  const ImageGray density = read_density_picture(settings, request.frame);
  context.density = density.empty() ? nullptr : &density;
  return make_sampling_map(settings, request.view, request.gaze_direction_render, context);
}

ImageGray planned_density(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                          int threads) {
  MapContext context = map_context(request, seed, threads);
  const ImageGray picture = read_density_picture(settings, request.frame);
  context.density = picture.empty() ? nullptr : &picture;
  if (!picture.empty() || (traits_of(settings.sampling).needs_gaze && request.gaze_direction_render)) {
    const Vec3d ahead{0, 0, -1};  // a picture needs no gaze
    if (std::optional<ImageGray> density =
            density_image(settings, request.view, request.gaze_direction_render.value_or(ahead), context)) {
      return *std::move(density);
    }
  }
  ImageGray density(request.width_px, request.height_px, 1);
  if (const RegionSampling* const regions = regions_of(settings.sampling);
      regions != nullptr && request.gaze_direction_render) {
    FoveationSettings own_counts = settings;
    own_counts.spp.reset();
    const SamplingMap map = make_sampling_map(own_counts, request.view, request.gaze_direction_render, context);
    std::vector<float> of_region;
    for (const MapRegion& region : map.regions) {
      const double pixels = std::max(1.0, static_cast<double>(region.pixels));
      of_region.push_back(static_cast<float>(region.nominal_samples / pixels / regions->samples[0]));
    }
    std::transform(map.region.pixels.begin(), map.region.pixels.end(), density.pixels.begin(),
                   [&](std::uint8_t region) { return of_region[region]; });
  }
  return density;
}

PlannedRates planned_rates(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                           int threads) {
  if (!traits_of(settings.sampling).needs_gaze || !request.gaze_direction_render) {
    const double spp = settings.spp.value_or(kUsualSpp);
    return {spp, spp};
  }
  const RegionSampling* const regions = regions_of(settings.sampling);
  const auto* const density = std::get_if<DensitySampling>(&settings.sampling);
  const double own_most = regions != nullptr   ? regions->samples[0]
                          : density != nullptr ? density->full_rate_spp
                                               : kUsualSpp;
  // By the sampling's own counts, to which `spp` is in proportion.
  FoveationSettings own_rates = settings;
  own_rates.spp.reset();
  const auto own_samples = static_cast<double>(planned_sampling_map(own_rates, request, seed, threads).samples());
  const double own_mean = std::max(1.0, own_samples) / (static_cast<double>(request.width_px) * request.height_px);
  const double mean = settings.spp.value_or(own_mean);
  return {mean, mean * own_most / own_mean};
}

}  // namespace gazetrace
