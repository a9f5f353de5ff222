// SPDX-License-Identifier: Apache-2.0
// Guides are what a pinhole sees at one instant, along a ray or a few through each pixel. Where lens, shutter or
// half-transparent surfaces made the samples see something else, the picture becomes what the samples themselves saw
// first, under the light that smoothing found. Everywhere else, too, samples know better than a few rays how much of a
// pixel each surface covers and what its texture is on average, once there are enough of them.
#pragma once

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

// What the n samples of a site saw: what shines, and each surface in the share of the site that it covers,
//   seen = shone / n + sum over its surfaces of (albedo / n) (smoothed reflected / smoothed albedo),
// has the noise of texture and coverage, but not that of light. It takes the picture's place where the samples' hits
// lie off the place at which the pinhole sees them, by a good part of a block, or are on blended surfaces
// (FirstHitSums), both averaged over five by five blocks, so that no sample decides for itself. There the picture
// becomes the mean of `seen` over three by three blocks, between the centres of blocks. What the picture then lacks of
// `seen`, here or anywhere, is given back as far as it is more than noise (keep_residuals.hpp).
//
// `input.sparse` has first hits. `picture` is filled from the guides. `cells` are smoothed.
void show_what_samples_saw(const FilterInput& input, const SurfaceCells& cells, const SmoothingSettings& settings,
                           SurfacePicture& picture);

}  // namespace gazetrace
