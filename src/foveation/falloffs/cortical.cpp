// SPDX-License-Identifier: Apache-2.0
// Cortical magnification: A/(e + e2) mm of visual cortex per degree, with e2 = 3.67 degrees (Dougherty et al., Journal
// of Vision 3(10), 2003). Visible detail is taken to be in proportion to it: f(e) = 60 e2/(e + e2), where 60 cycles per
// degree is the acuity at the fovea.
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_cortical(const FoveationSettings& /*settings*/, const PlanarView& /*view*/,
                         const Vec3d& /*gaze_direction*/) {
  constexpr double kHalfDeg = 3.67;
  constexpr double kFovealCpd = 60;
  return isotropic_cutoff([](double e) { return kFovealCpd * kHalfDeg / (e + kHalfDeg); });
}

}  // namespace gazetrace
