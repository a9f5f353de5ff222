// SPDX-License-Identifier: Apache-2.0
// Separates light from texture: of the samples, reflected radiance over the albedo of what they hit (surface_cells.hpp)
// is smoothed along surfaces (surface_smoothing.hpp). Each pixel takes it from those surfaces of the nearest blocks
// that are like the one it sees, multiplies it by its own albedo and adds the emission that it sees:
//   radiance(p) = emission(p) + albedo(p) * sum_c w(p, c) reflected(c) / sum_c w(p, c) albedo(c)
// Emission, misses and texture thus come from the first hits at full resolution, and no edge of theirs is smoothed.
// Pixels that lie between the same four blocks are computed together (fill_squares.hpp). Pixels that an edge crosses
// then become the mean of what their rays see, which most often is what a pixel beside them has (blend_edges.hpp).
#include <cstddef>
#include <utility>

#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "reconstruct/blend_edges.hpp"
#include "reconstruct/fill_squares.hpp"
#include "reconstruct/filter.hpp"
#include "reconstruct/keep_residuals.hpp"
#include "reconstruct/sampled_first_hits.hpp"
#include "reconstruct/surface_cells.hpp"
#include "reconstruct/surface_lookup.hpp"
#include "reconstruct/surface_smoothing.hpp"

namespace gazetrace {
namespace {

Frame guided_frame(const FilterInput& input) {
  const SamplingMap& map = input.map;
  const SmoothingSettings settings;
  SurfaceCells lattice = make_surface_cells(input.sparse, map, input.guides->camera, input.threads);
  smooth_surfaces(lattice, map, settings, input.threads);

  SurfacePicture picture(map.width_px, map.height_px);
  // AOVs are those of the linear filter.
  Frame frame = input.values.has_guides() ? filter_linear.frame(input) : make_frame(map, false);
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      const float density = static_cast<float>(input.values.count(i)) / static_cast<float>(site.pixels);
      for_each_pixel(map, site, [&](int x, int y) { frame.sample_count(x, y) = density; });
    }
  });
  const SurfaceLookup lookup(input, lattice, settings);
  fill_squares(input, lattice, settings, lookup, picture);
  blend_edges(input, lookup, lattice.site_of_pixel, picture);
  if (!input.sparse.first_hits.empty()) {
    show_what_samples_saw(input, lattice, settings, picture);
  }
  keep_residuals(input, settings, lattice.site_of_pixel, picture);
  for (std::size_t i = 0; i < picture.first_hits_variance.pixels.size(); ++i) {
    picture.variance.pixels[i] += picture.first_hits_variance.pixels[i];
    picture.error.pixels[i] += picture.first_hits_error.pixels[i];
  }
  frame.radiance = std::move(picture.radiance);
  frame.variance = std::move(picture.variance);
  frame.squared_error = std::move(picture.error);
  return frame;
}

}  // namespace

// One ray a pixel, whose cone is as wide as the pixel: finer texture would be noise, which no sample averages. The
// number of edge rays was measured in tests/benchmarks/filters.cpp.
const FilterDefinition filter_guided{
    .needs = {.guides = GuideSettings{.pixel_cone = 1, .edge_rays = 4}, .surfaces = true, .halves = true},
    .frame = guided_frame};

}  // namespace gazetrace
