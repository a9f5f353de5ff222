// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/nan.hpp"
#include "gaze/angles.hpp"
#include "gazetrace/gaze_events.hpp"
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

GazeUncertainty uncertainty_of(const GazeLog& log) {
  GazeUncertainty uncertainty{kNan, kNan};
  double sum = 0;
  double count = 0;
  for (const GazeCalibration& calibration : log.calibrations) {
    if (!std::isnan(calibration.mean_error_deg)) {
      sum += calibration.mean_error_deg;
      ++count;
    }
  }
  if (count > 0) {
    uncertainty.accuracy_deg = sum / count;
  }
  if (log.samples.size() > 1 && knows_angles(log)) {
    double squares = 0;
    double samples = 0;
    for (const EyeEvent& event : detect_events(log, default_event_preset(log)).events) {
      if (event.movement == EyeMovement::fixation && !std::isnan(event.dispersion_deg)) {
        const auto weight = static_cast<double>(event.last - event.first + 1);
        squares += weight * event.dispersion_deg * event.dispersion_deg;
        samples += weight;
      }
    }
    if (samples > 0) {
      uncertainty.precision_deg = std::sqrt(squares / samples);
    }
  }
  return uncertainty;
}

GazeUncertainty known_uncertainty(const GazeUncertainty& stated, const GazeLog& log) {
  const GazeUncertainty of_log = uncertainty_of(log);
  return {std::isnan(stated.accuracy_deg) ? of_log.accuracy_deg : stated.accuracy_deg,
          std::isnan(stated.precision_deg) ? of_log.precision_deg : stated.precision_deg};
}

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
