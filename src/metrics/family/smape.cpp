// SPDX-License-Identifier: Apache-2.0
// Symmetric mean absolute percentage error as a fraction, |t - r| / ((|t| + |r|) / 2), 0..2; 0 where both are 0
// (Makridakis, "Accuracy measures", International Journal of Forecasting 9, 1993). Mean over pixels and channels.
#include <cmath>

#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_smape(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  const auto error = [](double r, double t) {
    const double sum = std::fabs(t) + std::fabs(r);
    return sum > 0 ? 2 * std::fabs(t - r) / sum : 0.0;
  };
  return map_of_pixels(reference.light, test.light, settings.threads, [error](const Vec3f& r, const Vec3f& t) {
    return (error(r.x, t.x) + error(r.y, t.y) + error(r.z, t.z)) / 3;
  });
}

double metric_value_smape(double mean) {
  return mean;
}

}  // namespace gazetrace
