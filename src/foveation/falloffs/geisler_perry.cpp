// SPDX-License-Identifier: Apache-2.0
// Geisler and Perry, "A real-time foveated multiresolution system for low-bandwidth video communication", SPIE 3299,
// 1998: the contrast threshold CT(f, e) = CT0 exp(alpha f (e + e2)/e2) with alpha = 0.106, e2 = 2.3 degrees and
// CT0 = 1/64. A detail of contrast C is seen up to
//   f(e) = e2 ln(C/CT0) / (alpha (e + e2)).
#include <cmath>

#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_geisler_perry(const FoveationSettings& settings, const PlanarView& /*view*/,
                              const Vec3d& /*gaze_direction*/) {
  constexpr double kAlpha = 0.106;
  constexpr double kHalfDeg = 2.3;
  constexpr double kLeastContrast = 1.0 / 64;
  const double span = std::log(settings.parameters.contrast / kLeastContrast);
  return isotropic_cutoff([=](double e) { return kHalfDeg * span / (kAlpha * (e + kHalfDeg)); });
}

}  // namespace gazetrace
