// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gaze/angles.hpp"
#include "gazetrace/gaze_objects.hpp"

namespace gazetrace {
namespace {

// Standard deviation in each axis, in radians.
double spread_rad(const GazeUncertainty& uncertainty) {
  const double accuracy = uncertainty.accuracy_deg * std::sqrt(2 / kPi);
  const double precision = uncertainty.precision_deg / std::sqrt(2.0);
  return std::hypot(accuracy, precision) * kRadPerDeg;
}

}  // namespace

std::vector<Vec3d> gaze_cone(const Vec3d& direction, const GazeUncertainty& uncertainty, int count) {
  const TangentFrame frame(direction);
  const double spread = spread_rad(uncertainty);
  const double golden_angle = kPi * (3 - std::sqrt(5.0));
  std::vector<Vec3d> cone;
  cone.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double quantile = (i + 0.5) / count;
    const double radius = spread * std::sqrt(-2 * std::log1p(-quantile));
    const double turn = golden_angle * i;
    const Vec3d aside = frame.right * std::cos(turn) + frame.up * std::sin(turn);
    cone.push_back(frame.forward * std::cos(radius) + aside * std::sin(radius));
  }
  return cone;
}

double gaze_cone_95_deg(const GazeUncertainty& uncertainty) {
  return spread_rad(uncertainty) * std::sqrt(-2 * std::log(0.05)) * kDegPerRad;
}

}  // namespace gazetrace
