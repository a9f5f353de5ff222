// SPDX-License-Identifier: Apache-2.0
// HDR-FLIP's exposures and tone curves.
#pragma once

#include <vector>

#include "gazetrace/metrics.hpp"

namespace gazetrace {

void check_flip_exposures(const FlipExposures& exposures);  // Error(usage)
double exposure_ev(const FlipExposures& exposures, int i);

// Applies the curve to `scale` times the light, with negative light as 0. All arrays have the same length.
void tone_map(FlipToneMapper tone_mapper, float scale, const std::vector<float>& r, const std::vector<float>& g,
              const std::vector<float>& b, std::vector<float>& toned_r, std::vector<float>& toned_g,
              std::vector<float>& toned_b);

}  // namespace gazetrace
