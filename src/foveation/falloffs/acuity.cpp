// SPDX-License-Identifier: Apache-2.0
// Visual acuity after Reddy 2001: f(e) = 60 M(e) cycles per degree, with M from acuity_curve.hpp.
#include "foveation/acuity_curve.hpp"
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_acuity(const FoveationSettings& /*settings*/, const PlanarView& /*view*/,
                       const Vec3d& /*gaze_direction*/) {
  return isotropic_cutoff([](double e) { return kFovealAcuityCpd * relative_acuity(e); });
}

}  // namespace gazetrace
