// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/pilot.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "foveation/site_images.hpp"
#include "pipeline/frame_stages.hpp"

namespace gazetrace {
namespace {

constexpr int kLargestCellPx = 8;
constexpr int kLeastRows = 64;
constexpr std::uint64_t kPilotTag = 0x50494c4f54ULL;  // "PILOT"

// Single pixels, however low the rates are: blocks of a small frame would stand for much larger ones of the frame.
SamplingMap pilot_map(const PlanarView& view, const ImageGray& rates, const MapContext& context) {
  FoveationSettings settings;
  DensitySampling sampling = density_of_picture();
  sampling.least_density = 1e-6;
  settings.sampling = std::move(sampling);
  settings.max_block_px = 1;
  MapContext own = context;
  own.density = &rates;
  return make_sampling_map(settings, view, std::nullopt, own);
}

ImageGray luminance_image(const ImageRgb& radiance) {
  ImageGray image(radiance.width_px, radiance.height_px);
  std::transform(radiance.pixels.begin(), radiance.pixels.end(), image.pixels.begin(),
                 [](const Vec3f& pixel) { return luminance(pixel); });
  return image;
}

// What a frame's reconstruction says of its own error; of filters that make no estimate of it, what their samples say.
ImageGray squared_error_of(const Frame& frame) {
  return frame.squared_error.empty() ? frame.variance : frame.squared_error;
}

}  // namespace

int pilot_cell_px(const FrameRequest& request) {
  int cell_px = kLargestCellPx;
  while (cell_px > 1 && request.height_px / cell_px < kLeastRows) {
    cell_px /= 2;
  }
  return cell_px;
}

PlanarView pilot_view(const FrameRequest& request, int cell_px) {
  PlanarView view = request.view;
  view.width_px = (request.width_px + cell_px - 1) / cell_px;
  view.height_px = (request.height_px + cell_px - 1) / cell_px;
  view.step_x *= static_cast<double>(request.width_px) / view.width_px;
  view.step_y *= static_cast<double>(request.height_px) / view.height_px;
  return view;
}

Pilot trace_pilot(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings,
                  const ImageGray& rates, std::uint64_t round) {
  Pilot pilot;
  pilot.cell_px = pilot_cell_px(request);
  pilot.view = pilot_view(request, pilot.cell_px);
  const double share = 1.0 / pilot.cell_px;
  const Reconstruction reconstruction(settings.reconstruction);
  TraceSettings trace = reconstruction.trace_settings(settings.trace);
  trace.seed = hash_combine(hash_combine(settings.trace.seed, kPilotTag), round);
  trace.footprint = share;
  trace.guides = false;
  trace.only_pixel.reset();
  const SamplingMap map = pilot_map(pilot.view, rates, map_context(request, trace.seed, settings.threads));
  SparseFrame sparse =
      timed(pilot.times.trace_ms, [&] { return scene.trace(request.camera, request.frame, map, trace); });
  std::optional<Guides> guides;
  if (std::optional<GuideSettings> wanted = reconstruction.guide_settings(settings.trace)) {
    // A pixel of the frame is too small beside a cell to be crossed by many edges.
    wanted->pixel_cone *= share;
    wanted->edge_rays = 0;
    guides = timed(pilot.times.guides_ms,
                   [&] { return scene.guides(request.camera, map.width_px, map.height_px, *wanted); });
  }
  const Frame frame = timed(pilot.times.reconstruct_ms, [&] {
    return reconstruction.frame(sparse, map, guides ? &*guides : nullptr, settings.threads);
  });
  pilot.radiance = frame.radiance;
  pilot.luminance = luminance_image(frame.radiance);
  pilot.squared_error = squared_error_of(frame);
  pilot.spp = expected_spp_of(map);
  pilot.stats = std::move(sparse.stats);
  return pilot;
}

}  // namespace gazetrace
