// SPDX-License-Identifier: Apache-2.0
// Every pixel is a block of its own with `uniform_spp` samples. This is the baseline that foveation is measured
// against.
#include "foveation/falloff.hpp"

namespace gazetrace {

Layout uniform_layout(std::uint32_t samples_per_pixel, int width_px, int height_px) {
  return {{{"uniform", 1, samples_per_pixel, SampleUnit::per_pixel}}, Image<std::uint8_t>(width_px, height_px, 0)};
}

Falloff falloff_uniform(const FoveationSettings& settings, const PlanarView& view, const Vec3d& /*gaze_direction*/) {
  return uniform_layout(settings.uniform_spp, view.width_px, view.height_px);
}

}  // namespace gazetrace
