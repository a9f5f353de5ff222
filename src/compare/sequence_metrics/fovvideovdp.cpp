// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP of luminance. The metric itself is in metrics/fovvideovdp.cpp.
#include "compare/sequence_metric.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

class FovVideoVdpOfFrames : public SequenceMetric {
 public:
  FovVideoVdpOfFrames(const FovVideoVdpSettings& settings, int width_px, int height_px)
      : metric_(settings, width_px, height_px) {}

  // Frames without gaze are not scored, but enter the metric's window in time.
  std::optional<MetricMap> add(const LuminanceFrame& frame) override {
    if (!frame.gaze_px) {
      metric_.prime(frame.reference, frame.test);
      return std::nullopt;
    }
    FovVideoVdpFrame scored = metric_.add(frame.reference, frame.test, frame.gaze_px, true);
    return MetricMap{std::move(scored.map), 0, scored.q};
  }

 private:
  FovVideoVdp metric_;
};

}  // namespace

std::unique_ptr<SequenceMetric> make_fovvideovdp(const ComparisonSettings& settings, int width_px, int height_px) {
  FovVideoVdpSettings metric;
  metric.geometry = fovvideovdp_geometry(*settings.view);
  metric.frames_per_second = settings.frames_per_second;
  metric.original_border = settings.original_border;
  metric.pooling_weights = settings.pooling_weights;
  metric.threads = settings.metric.threads;
  return std::make_unique<FovVideoVdpOfFrames>(metric, width_px, height_px);
}

// The mean over frames is that of Q, the mean over pixels that of the local difference in JOD.
double sequence_value_fovvideovdp(double mean) {
  return fovvideovdp_jod(mean);
}
double sequence_local_value_fovvideovdp(double mean) {
  constexpr double kNoDifference = 10;
  return kNoDifference - mean;
}

}  // namespace gazetrace
