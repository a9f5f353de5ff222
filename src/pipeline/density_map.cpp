// SPDX-License-Identifier: Apache-2.0
// Densities that come from outside: pictures that say where the samples of a frame go.
#include <algorithm>
#include <filesystem>

#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "output/exr.hpp"

namespace gazetrace {

ImageGray read_density_map(const FoveationSettings& settings, std::int32_t frame) {
  const std::string path = frame_file_name(settings.density_map, frame);
  ImageGray density = read_exr_gray(path);
  check_density_picture(density, settings, path);
  return density;
}

std::vector<std::string> density_map_files(const FoveationSettings& settings) {
  std::vector<std::string> files;
  for (const std::int32_t frame : find_frames(settings.density_map)) {
    files.push_back(frame_file_name(settings.density_map, frame));
  }
  return files;
}

SamplingMap planned_sampling_map(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                                 int threads) {
  MapContext context = map_context(request, seed, threads);
  ImageGray density;
  if (settings.falloff == "map") {
    density = read_density_map(settings, request.frame);
    context.density = &density;
  }
  return make_sampling_map(settings, request.view, request.gaze_direction_render, context);
}

}  // namespace gazetrace
