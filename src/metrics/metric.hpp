// SPDX-License-Identifier: Apache-2.0
// What a metric is: a map and its mean from two pictures of the same size, and the printed number of a mean.
#pragma once

#include <cstddef>
#include <functional>

#include "gazetrace/metrics.hpp"

namespace gazetrace {

// Two functions per line of metrics.def.
#define METRIC(name, input, better, description)                                                                      \
  MetricMap metric_##name(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings); \
  double metric_value_##name(double mean);
#include "metrics/metrics.def"
#undef METRIC

// A value a pixel, each from the two pixels alone, and their mean: rows are summed in double, then the rows.
MetricMap map_of_pixels(const ImageRgb& reference, const ImageRgb& test, int threads,
                        const std::function<double(const Vec3f& reference, const Vec3f& test)>& value);

// Mean of a map without its margin, summed the same way.
double mean_of_map(const ImageGray& map, int margin_px, int threads);

}  // namespace gazetrace
