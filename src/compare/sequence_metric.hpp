// SPDX-License-Identifier: Apache-2.0
// Metrics of whole sequences: the score of a frame depends on the frames before it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/compare.hpp"

namespace gazetrace {

// The luminance of both pictures in cd/m2, and the gaze where there is one.
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
  // Adds the next frame. Empty where the frame is not scored.
  virtual std::optional<MetricMap> add(const LuminanceFrame& frame) = 0;
};

// Each line of sequence_metrics.def has three functions: one makes the metric for pictures of one size, the others turn
// a mean over frames, and a mean over a part of the picture, into the printed number.
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
// The printed numbers of any metric, of pictures or of sequences.
double comparison_value(const std::string& metric, double mean);
double comparison_local_value(const std::string& metric, double mean);

}  // namespace gazetrace
