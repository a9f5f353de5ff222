// SPDX-License-Identifier: Apache-2.0
// The source paper announces a "quadric" fall-off without giving a formula. This is its natural reading: in place of
// steps, a parabola that meets the outer rate without a kink,
//   p(e) = p_p + (1 - p_p) ((e_p - e)/(e_p - e_f))^2   for e_f < e < e_p, 1 before and p_p beyond.
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_quadric(const FoveationSettings& settings, const PlanarView& /*view*/,
                        const Vec3d& /*gaze_direction*/) {
  const double inner_deg = settings.parameters.ramp.x;
  const double outer_deg = settings.parameters.ramp.y;
  const double least = settings.parameters.ramp.z;
  return isotropic_density([=](double e) {
    if (e <= inner_deg) {
      return 1.0;
    }
    const double left = e < outer_deg ? (outer_deg - e) / (outer_deg - inner_deg) : 0.0;
    return least + (1 - least) * left * left;
  });
}

}  // namespace gazetrace
