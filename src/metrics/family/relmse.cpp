// SPDX-License-Identifier: Apache-2.0
// Relative mean squared error, (t - r)^2 / (r^2 + epsilon), mean over pixels and channels (Rousselle et al., "Adaptive
// sampling and reconstruction using greedy error minimization", 2011, with epsilon 0.01).
#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_relmse(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  const double epsilon = settings.relmse_epsilon;
  const auto error = [epsilon](double r, double t) { return (t - r) * (t - r) / (r * r + epsilon); };
  return map_of_pixels(reference.light, test.light, settings.threads, [error](const Vec3f& r, const Vec3f& t) {
    return (error(r.x, t.x) + error(r.y, t.y) + error(r.z, t.z)) / 3;
  });
}

double metric_value_relmse(double mean) {
  return mean;
}

}  // namespace gazetrace
