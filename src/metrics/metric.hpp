// SPDX-License-Identifier: Apache-2.0
// A metric consists of two functions: one makes a map and its mean from two pictures of the same size, the other turns
// a mean into the printed number.
#pragma once

#include <cstddef>
#include <functional>

#include "gazetrace/metrics.hpp"

namespace gazetrace {

// Both are declared for each line of metrics.def.
#define METRIC(name, input, better, description)                                                                      \
  MetricMap metric_##name(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings); \
  double metric_value_##name(double mean);
#include "metrics/metrics.def"
#undef METRIC

// For metrics whose value at a pixel depends on that pixel alone: the map and its mean, summed in double over each row
// and then over the rows.
MetricMap map_of_pixels(const ImageRgb& reference, const ImageRgb& test, int threads,
                        const std::function<double(const Vec3f& reference, const Vec3f& test)>& value);

// The mean of a map without its margin, summed in the same way.
double mean_of_map(const ImageGray& map, int margin_px, int threads);

}  // namespace gazetrace
