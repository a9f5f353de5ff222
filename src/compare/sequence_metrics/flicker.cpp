// SPDX-License-Identifier: Apache-2.0
// Flicker in excess of the reference's. The metric itself is in metrics/flicker.cpp.
#include "gazetrace/flicker.hpp"

#include <algorithm>
#include <cmath>

#include "compare/sequence_metric.hpp"
#include "metrics/metric.hpp"

namespace gazetrace {
namespace {

class FlickerOfFrames : public SequenceMetric {
 public:
  explicit FlickerOfFrames(const FlickerSettings& settings) : meter_(settings), threads_(settings.threads) {}

  std::optional<MetricMap> add(const LuminanceFrame& frame) override {
    std::optional<ImageGray> map = meter_.add(frame.reference, frame.test, frame.gaze_px);
    if (!map) {
      return std::nullopt;
    }
    const double mean = mean_of_map(*map, 0, threads_);
    return MetricMap{std::move(*map), 0, mean};
  }

 private:
  FlickerMeter meter_;
  int threads_;
};

}  // namespace

std::unique_ptr<SequenceMetric> make_flicker(const ComparisonSettings& settings, int /*width_px*/, int /*height_px*/) {
  return std::make_unique<FlickerOfFrames>(
      FlickerSettings{*settings.view, settings.frames_per_second, settings.metric.threads});
}

// Means are means of squares.
double sequence_value_flicker(double mean) {
  return std::sqrt(mean);
}
double sequence_local_value_flicker(double mean) {
  return std::sqrt(mean);
}

}  // namespace gazetrace
