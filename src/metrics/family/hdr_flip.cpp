// SPDX-License-Identifier: Apache-2.0
// HDR-FLIP of linear light. Exposures that the settings leave empty are computed from the reference.
#include "metrics/metric.hpp"

namespace gazetrace {

MetricMap metric_hdr_flip(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  const FlipExposures exposures = flip_exposures(reference.light, settings.hdr_flip);
  MetricMap map;
  map.values = hdr_flip_map(reference.light, test.light, exposures, settings.hdr_flip.tone_mapper,
                            settings.pixels_per_degree, settings.threads)
                   .values;
  map.mean = mean_of_map(map.values, 0, settings.threads);
  return map;
}

double metric_value_hdr_flip(double mean) {
  return mean;
}

}  // namespace gazetrace
