// SPDX-License-Identifier: Apache-2.0
// Peak signal-to-noise ratio, -10 log10 of the mean squared error of code values, whose peak is 1. The map holds
// squared errors; a mean of 0 is +Inf decibels.
#include <cmath>

#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_psnr(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  return map_of_pixels(reference.code, test.code, settings.threads, [](const Vec3f& r, const Vec3f& t) {
    const Vec3d d = to_double(t) - to_double(r);
    return dot(d, d) / 3;
  });
}

double metric_value_psnr(double mean) {
  return -10 * std::log10(mean);
}

}  // namespace gazetrace
