// SPDX-License-Identifier: Apache-2.0
// Visual-polar space, Koskela et al., "Foveated Real-Time Path Tracing in Visual-Polar Space", EGSR 2019, in outline: a
// polar buffer about the gaze whose radial axis is warped by visual acuity, and which is cut to a triangle towards the
// gaze, where equal steps of the angle would crowd thousands of samples into a pixel. With u(e) = integral of M(e) and
// as many steps around at every eccentricity beyond the acuity's plateau e_a, fewer in proportion to sin e within it,
// samples per solid angle go as the Jacobian
//   M(e) / sin e  beyond e_a,  M(e) / sin e_a  within,
// relative to the fovea M(e) min(1, sin e_a / sin e). A grid of f x f cells a square degree carries f cycles: the
// cut-off is 60 times the root of it. From 90 degrees on, sin e is held: a full turn behind the eye shrinks again.
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
