// SPDX-License-Identifier: Apache-2.0
// Visual acuity relative to the fovea, after Reddy, "Perceptually Optimized 3D Graphics", IEEE CG&A 21(5), 2001:
//   M(e) = 1                       e <= 5.79 degrees
//          7.49 / (0.3 e + 1)^2    beyond
#pragma once

namespace gazetrace {

constexpr double kAcuityPlateauDeg = 5.79;
constexpr double kFovealAcuityCpd = 60;

constexpr double relative_acuity(double eccentricity_deg) {
  const double root = 0.3 * eccentricity_deg + 1;
  return eccentricity_deg <= kAcuityPlateauDeg ? 1.0 : 7.49 / (root * root);
}

}  // namespace gazetrace
