// SPDX-License-Identifier: Apache-2.0
// The probability of a path in Koskela, "Foveated Path Tracing with Fast Reconstruction and Efficient Sample
// Distribution", 2020, eq. 4.1, taken as a density for any number of samples:
//   p(e) = 1                               e <= e_f
//          1 + (p_p - 1)(e - e_f)/(e_p - e_f)  e <= e_p
//          p_p                             beyond
// Weier et al. 2016 use the same shape. The default angles (5 and 25 degrees) and p_p = 0.1 are within the usual range.
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_linear(const FoveationSettings& settings, const PlanarView& /*view*/, const Vec3d& /*gaze_direction*/) {
  const double inner_deg = settings.parameters.ramp.x;
  const double outer_deg = settings.parameters.ramp.y;
  const double least = settings.parameters.ramp.z;
  return isotropic_density([=](double e) {
    if (e <= inner_deg) {
      return 1.0;
    }
    return e < outer_deg ? 1 + (least - 1) * (e - inner_deg) / (outer_deg - inner_deg) : least;
  });
}

}  // namespace gazetrace
