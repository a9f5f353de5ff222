// SPDX-License-Identifier: Apache-2.0
// What the samples of a site say about the light on each surface they fell on, ready to be smoothed over neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// The light is the quotient of two means: reflected radiance over albedo. Both are smoothed with the same weights and
// divided last, so that over even weights the mean of what comes out is the mean of what was traced.
struct SurfaceCell {
  Vec3f reflected, albedo;  // means over the samples
  Vec3f normal;             // unit, or zero where normals cancel
  Vec3f place_m;            // relative to the eye
  float samples = 0;
  float footprint_m = 0;  // what the site's block covers there
  float light = 0;        // luminance of reflected / albedo
  float square = 0;       // mean square of the samples' own light
  float variance = 0;     // of `light`
  SurfaceKind kind = SurfaceKind::diffuse;
};

struct SurfaceCells {
  std::vector<SurfaceCell> cells;
  std::vector<std::uint32_t> first;  // as SparseFrame::first_surface
  Image<std::uint32_t> site_of_pixel;
};

SurfaceCells make_surface_cells(const SparseFrame& sparse, const SamplingMap& map, const GuideCamera& camera,
                                int threads);

}  // namespace gazetrace
