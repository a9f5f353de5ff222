// SPDX-License-Identifier: Apache-2.0
#include "compare/sequence_metric.hpp"

#include <algorithm>

#include "gazetrace/error.hpp"

namespace gazetrace {

std::vector<MetricInfo> sequence_metrics() {
  return {
#define SEQUENCE_METRIC(name, better, needs_gaze, description) \
  {#name, MetricInput::code, MetricDirection::better, description, needs_gaze},
#include "compare/sequence_metrics.def"
#undef SEQUENCE_METRIC
  };
}

bool is_sequence_metric(const std::string& name) {
  const std::vector<MetricInfo> all = sequence_metrics();
  return std::any_of(all.begin(), all.end(), [&](const MetricInfo& info) { return info.name == name; });
}

std::unique_ptr<SequenceMetric> make_sequence_metric(const std::string& name, const ComparisonSettings& settings,
                                                     int width_px, int height_px) {
#define SEQUENCE_METRIC(metric, better, needs_gaze, description) \
  if (name == #metric) {                                         \
    return make_##metric(settings, width_px, height_px);         \
  }
#include "compare/sequence_metrics.def"
#undef SEQUENCE_METRIC
  throw Error(ErrorKind::usage, "metric", "unknown metric " + name);
}

double comparison_value(const std::string& metric, double mean) {
#define SEQUENCE_METRIC(name, better, needs_gaze, description) \
  if (metric == #name) {                                       \
    return sequence_value_##name(mean);                        \
  }
#include "compare/sequence_metrics.def"
#undef SEQUENCE_METRIC
  return metric_value(metric, mean);
}

double comparison_local_value(const std::string& metric, double mean) {
#define SEQUENCE_METRIC(name, better, needs_gaze, description) \
  if (metric == #name) {                                       \
    return sequence_local_value_##name(mean);                  \
  }
#include "compare/sequence_metrics.def"
#undef SEQUENCE_METRIC
  return metric_value(metric, mean);
}

}  // namespace gazetrace
