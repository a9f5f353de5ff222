// SPDX-License-Identifier: Apache-2.0
// Root of the mean squared error: squares are averaged, and the root is taken of the mean.
#include <cmath>

#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_rmse(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  return metric_mse(reference, test, settings);
}

double metric_value_rmse(double mean) {
  return std::sqrt(mean);
}

}  // namespace gazetrace
