// SPDX-License-Identifier: Apache-2.0
// LDR-FLIP of display code values. The metric itself is in ../flip.cpp.
#include "metrics/code_values.hpp"
#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_flip(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  MetricMap map;
  map.values = flip_map(light_of_code(reference.code, settings.response, settings.peak_cd_m2, settings.threads),
                        light_of_code(test.code, settings.response, settings.peak_cd_m2, settings.threads),
                        settings.pixels_per_degree, settings.threads);
  map.mean = mean_of_map(map.values, 0, settings.threads);
  return map;
}

double metric_value_flip(double mean) {
  return mean;
}

}  // namespace gazetrace
