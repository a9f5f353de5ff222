// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/metrics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "core/named.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "metrics/metric.hpp"

namespace gazetrace {
namespace {

void check_finite(const ImageRgb& image, const char* which) {
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      if (!is_finite(image(x, y))) {
        throw Error(ErrorKind::input, which, fmt::format("pixel {},{} is not finite", x, y), "repair the picture");
      }
    }
  }
}

void check_pair(const std::string& metric, const ImageRgb& reference, const ImageRgb& test) {
  if (reference.empty() || test.empty()) {
    throw Error(
        ErrorKind::usage, metric,
        "needs " +
            std::string(metric_by_name(metric).input == MetricInput::light ? "linear light" : "display code values") +
            " of both pictures");
  }
  if (reference.width_px != test.width_px || reference.height_px != test.height_px) {
    throw Error(ErrorKind::usage, metric,
                fmt::format("the reference has {}x{} pixels, the test {}x{}", reference.width_px, reference.height_px,
                            test.width_px, test.height_px),
                "compare pictures of one size");
  }
  check_finite(reference, "reference");
  check_finite(test, "test");
}

}  // namespace

const std::vector<MetricInfo>& metrics() {
  static const std::vector<MetricInfo> kMetrics = {
#define METRIC(name, input, better, description) {#name, MetricInput::input, MetricDirection::better, description},
#include "metrics/metrics.def"
#undef METRIC
  };
  return kMetrics;
}

const MetricInfo& metric_by_name(const std::string& name) {
  return find_named(metrics(), name, "metric", "metric");
}

MetricMap measure(const std::string& metric, const MetricPicture& reference, const MetricPicture& test,
                  const MetricSettings& settings) {
  const bool light = metric_by_name(metric).input == MetricInput::light;
  check_pair(metric, light ? reference.light : reference.code, light ? test.light : test.code);
#define METRIC(name, input, better, description)     \
  if (metric == #name) {                             \
    return metric_##name(reference, test, settings); \
  }
#include "metrics/metrics.def"
#undef METRIC
  throw Error(ErrorKind::usage, "metric", "unknown metric " + metric);
}

double metric_value(const std::string& metric, double mean) {
  metric_by_name(metric);
#define METRIC(name, input, better, description) \
  if (metric == #name) {                         \
    return metric_value_##name(mean);            \
  }
#include "metrics/metrics.def"
#undef METRIC
  return mean;
}

MetricMap map_of_pixels(const ImageRgb& reference, const ImageRgb& test, int threads,
                        const std::function<double(const Vec3f& reference, const Vec3f& test)>& value) {
  MetricMap map;
  map.values = ImageGray(reference.width_px, reference.height_px);
  std::vector<double> row_sum(static_cast<std::size_t>(reference.height_px));
  parallel_for(row_sum.size(), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < reference.width_px; ++x) {
      const double v = value(reference(x, y), test(x, y));
      row_sum[row] += v;
      map.values(x, y) = static_cast<float>(v);
    }
  });
  map.mean = std::accumulate(row_sum.begin(), row_sum.end(), 0.0) / static_cast<double>(reference.pixels.size());
  return map;
}

double mean_of_map(const ImageGray& map, int margin_px, int threads) {
  const int width = map.width_px - 2 * margin_px;
  const int height = map.height_px - 2 * margin_px;
  std::vector<double> row_sum(static_cast<std::size_t>(height));
  parallel_for(row_sum.size(), threads, [&](std::size_t row) {
    const float* values = &map.pixels[map.index(margin_px, margin_px + static_cast<int>(row))];
    row_sum[row] = std::accumulate(values, values + width, 0.0);
  });
  return std::accumulate(row_sum.begin(), row_sum.end(), 0.0) / (static_cast<double>(width) * height);
}

}  // namespace gazetrace
