// SPDX-License-Identifier: Apache-2.0
// What the filter "guided" does, with its own smoothing (smooth_surfaces) or another one: light is smoothed on
// surfaces, and every pixel takes it from those that are like the one it sees.
#pragma once

#include "reconstruct/filter.hpp"
#include "reconstruct/surface_cells.hpp"
#include "reconstruct/surface_smoothing.hpp"

namespace gazetrace {

// One ray a pixel, whose cone is as wide as the pixel: finer texture would be noise, which no sample averages. The
// number of edge rays was measured in tests/benchmarks/filters.cpp.
inline constexpr ReconstructionNeeds kSurfaceNeeds{
    .guides = GuideSettings{.pixel_cone = 1, .edge_rays = 4}, .surfaces = true, .halves = true};

using SmoothSurfaces = void (*)(SurfaceCells& cells, const SamplingMap& map, const SmoothingSettings& settings,
                                int threads);
Frame frame_from_surfaces(const FilterInput& input, SmoothSurfaces smooth);

}  // namespace gazetrace
