// SPDX-License-Identifier: Apache-2.0
// Groups of light as pictures that add up to the frame's.
#pragma once

#include <vector>

#include "gazetrace/image.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

// Whether a filter's weights depend on neither light nor its variance, so that it may be applied to parts of the light.
bool is_linear(const Reconstruction& filter);

// Each group through a linear filter, from SparseFrame::light_groups.
std::vector<ImageRgb> filter_light_groups(const SparseFrame& sparse, const SamplingMap& map,
                                          const Reconstruction& filter, int threads);

// Brings the layers, channel by channel, to where they add up to the picture, in the proportions that they have. Where
// they have no light and the picture has some, all of it counts as diffuse and indirect.
void scale_to_picture(const ImageRgb& picture, std::vector<ImageRgb>& layers);

}  // namespace gazetrace
