// SPDX-License-Identifier: Apache-2.0
// A metric that sees time: what a frame scores depends on the frames before it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/compare.hpp"

namespace gazetrace {

// Luminance of both, in cd/m2, and the gaze where there is one.
struct LuminanceFrame {
  const ImageGray& reference;
  const ImageGray& test;
  std::optional<Vec2d> gaze_px;
};

class SequenceMetric {
 public:
  SequenceMetric() = default;
  virtual ~SequenceMetric() = default;
  SequenceMetric(const SequenceMetric&) = delete;
  SequenceMetric& operator=(const SequenceMetric&) = delete;
  // Frames in the order of time. Empty: not scored.
  virtual std::optional<MetricMap> add(const LuminanceFrame& frame) = 0;
};

// Three functions per line of sequence_metrics.def: the metric over pictures of one size, and the printed numbers of a
// mean over a frame or frames and of one over a part of the picture.
#define SEQUENCE_METRIC(name, better, needs_gaze, description)                                                  \
  std::unique_ptr<SequenceMetric> make_##name(const ComparisonSettings& settings, int width_px, int height_px); \
  double sequence_value_##name(double mean);                                                                    \
  double sequence_local_value_##name(double mean);
#include "compare/sequence_metrics.def"
#undef SEQUENCE_METRIC

std::vector<MetricInfo> sequence_metrics();
bool is_sequence_metric(const std::string& name);
std::unique_ptr<SequenceMetric> make_sequence_metric(const std::string& name, const ComparisonSettings& settings,
                                                     int width_px, int height_px);
// Of any metric.
double comparison_value(const std::string& metric, double mean);
double comparison_local_value(const std::string& metric, double mean);

}  // namespace gazetrace
