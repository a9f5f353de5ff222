// SPDX-License-Identifier: Apache-2.0
// The main sequence: how fast saccades of an amplitude are.
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "gazetrace/gaze_measure.hpp"

namespace gazetrace {
namespace {

bool is_measured_saccade(const EyeEvent& event) {
  return (event.movement == EyeMovement::saccade || event.movement == EyeMovement::microsaccade) &&
         event.amplitude_deg > 0 && event.peak_velocity_deg_s > 0 && std::isfinite(event.amplitude_deg) &&
         std::isfinite(event.peak_velocity_deg_s);
}

}  // namespace

MainSequence fit_main_sequence(const std::vector<EyeEvent>& events) {
  constexpr double kLeastDeg = 0.5;
  constexpr double kMostDeg = 30;
  std::vector<double> x;
  std::vector<double> y;
  for (const EyeEvent& event : events) {
    if (is_measured_saccade(event) && event.amplitude_deg >= kLeastDeg && event.amplitude_deg <= kMostDeg) {
      x.push_back(std::log10(event.amplitude_deg));
      y.push_back(std::log10(event.peak_velocity_deg_s));
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MainSequence fit{x.size(), nan, nan, nan};
  if (x.size() < 5) {
    return fit;
  }
  const double mean_x = mean_of(x);
  const double mean_y = mean_of(y);
  double xx = 0;
  double xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (xx > 0) {
    fit.exponent = xy / xx;
    fit.factor = std::pow(10.0, mean_y - fit.exponent * mean_x);
    fit.correlation = correlation(x, y);
  }
  return fit;
}

}  // namespace gazetrace
