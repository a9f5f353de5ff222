// SPDX-License-Identifier: Apache-2.0
// Acuity for an image that moves over the retina, after Reddy, "Perceptually Optimized 3D Graphics", IEEE CG&A 21(5),
// 2001. The highest visible frequency at a speed v of the retinal image is
//   G(v) = 60                       v <= 0.825 deg/s
//          57.69 - 27.78 log10 v    v <= 118.3 deg/s
//          0.1                      beyond                     cycles/deg,
// and G(v) / 60 multiplies the acuity at an eccentricity. The density goes with its square, since samples cover an
// area. On a still screen the speed is that of the gaze; motion in the picture, and that the eye may follow it, are
// not known here.
#include <cmath>

#include "foveation/terms/terms.hpp"

namespace gazetrace {

double retinal_velocity_factor(double speed_deg_s) {
  constexpr double kStillCpd = 60;
  const double cpd = speed_deg_s <= 0.825   ? kStillCpd
                     : speed_deg_s <= 118.3 ? 57.69 - 27.78 * std::log10(speed_deg_s)
                                            : 0.1;
  const double part = cpd / kStillCpd;
  return part < 1 ? part * part : 1.0;
}

}  // namespace gazetrace
