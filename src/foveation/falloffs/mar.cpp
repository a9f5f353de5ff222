// SPDX-License-Identifier: Apache-2.0
// Guenter et al., "Foveated 3D Graphics", ACM TOG 31(6), 2012: the smallest cycle that is resolved grows in proportion
// to eccentricity, w(e) = m e + w0 degrees, f = 1/w. m = 0.022 (conservative) to 0.0275 (aggressive) from their user
// study, w0 = 1/48 degree. The paper rendered its layers with antialiasing, jitter and temporal filtering; without
// them, such low sampling rates are visible.
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_mar(const FoveationSettings& settings, const PlanarView& /*view*/, const Vec3d& /*gaze_direction*/) {
  const double slope = settings.parameters.mar_slope;
  const double foveal_deg = settings.parameters.mar_foveal_deg;
  return isotropic_cutoff([=](double e) { return 1 / (slope * e + foveal_deg); });
}

}  // namespace gazetrace
