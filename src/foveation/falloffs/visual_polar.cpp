// SPDX-License-Identifier: Apache-2.0
// The sample density of visual-polar space, in outline (Koskela et al., "Foveated Real-Time Path Tracing in
// Visual-Polar Space", EGSR 2019): a polar buffer about the gaze whose radial axis is warped by visual acuity, and
// which narrows to a triangle towards the gaze, where equal steps of the angle would put thousands of samples into a
// pixel. The radial coordinate is u(e) = integral of M(e). Beyond the plateau e_a of the acuity, every eccentricity has
// the same number of steps around; within it, the number falls in proportion to sin e. Samples per solid angle then go
// as the Jacobian
//   M(e) / sin e  beyond e_a,  M(e) / sin e_a  within,
// or, relative to the fovea, M(e) min(1, sin e_a / sin e). A grid of f x f cells per square degree carries f cycles, so
// the cut-off is 60 times the root of it. Beyond 90 degrees, where the circle about the gaze shrinks again, sin e is
// held at 1.
#include <cmath>

#include "foveation/acuity_curve.hpp"
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_visual_polar(const FoveationSettings& /*settings*/, const PlanarView& /*view*/,
                             const Vec3d& /*gaze_direction*/) {
  const double plateau = std::sin(kAcuityPlateauDeg * kRadPerDeg);
  return isotropic_cutoff([plateau](double e) {
    const double around = e <= kAcuityPlateauDeg ? 1.0 : plateau / (e < 90 ? std::sin(e * kRadPerDeg) : 1.0);
    return kFovealAcuityCpd * std::sqrt(relative_acuity(e) * around);
  });
}

}  // namespace gazetrace
