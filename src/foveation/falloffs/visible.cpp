// SPDX-License-Identifier: Apache-2.0
// The rates that follow from a pilot of the frame (pipeline/quality/adaptive_rates.hpp), which has limits of its own
// for them. Blocks are for places with less than two samples a pixel only: their light is known by the pixel, unlike
// that of models which take detail away on purpose.
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_visible(const FoveationSettings& /*settings*/, const PlanarView& /*view*/, const Vec3d& /*gaze*/) {
  DensityModel model = picture_density();
  model.own_floor = 1e-9;
  model.own_block_samples = 2;
  return model;
}

}  // namespace gazetrace
