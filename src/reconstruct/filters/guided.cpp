// SPDX-License-Identifier: Apache-2.0
// Separates light from texture: of the samples, reflected radiance over the albedo of what they hit (surface_cells.hpp)
// is smoothed along surfaces (surface_smoothing.hpp). Each pixel takes it from those surfaces of the nearest blocks
// that are like the one it sees, multiplies it by its own albedo and adds the emission that it sees:
//   radiance(p) = emission(p) + albedo(p) * sum_c w(p, c) reflected(c) / sum_c w(p, c) albedo(c)
// Emission, misses and texture thus come from the first hits at full resolution, and no edge of theirs is smoothed.
// Pixels that lie between the same four blocks are computed together (fill_squares.hpp). Pixels that an edge crosses
// then become the mean of what their rays see, which most often is what a pixel beside them has (blend_edges.hpp).
#include "reconstruct/surface_frame.hpp"

namespace gazetrace {

const FilterDefinition filter_guided{.needs = kSurfaceNeeds, .frame = [](const FilterInput& input) {
                                       return frame_from_surfaces(input, smooth_surfaces);
                                     }};

}  // namespace gazetrace
