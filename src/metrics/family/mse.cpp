// SPDX-License-Identifier: Apache-2.0
// Mean over pixels and channels of (t - r)^2.
#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_mse(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  return map_of_pixels(reference.light, test.light, settings.threads, [](const Vec3f& r, const Vec3f& t) {
    const Vec3d d = to_double(t) - to_double(r);
    return dot(d, d) / 3;
  });
}

double metric_value_mse(double mean) {
  return mean;
}

}  // namespace gazetrace
