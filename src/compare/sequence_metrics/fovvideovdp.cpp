// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP of luminance; metrics/fovvideovdp.cpp has the metric.
#include "compare/sequence_metric.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

class FovVideoVdpOfFrames : public SequenceMetric {
 public:
  FovVideoVdpOfFrames(const FovVideoVdpSettings& settings, int width_px, int height_px)
      : metric_(settings, width_px, height_px) {}

  // Frames without gaze keep the window in time going.
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
  // The metric takes a picture to fill its display: a display of the picture's own pixels and size. Distance 1 m.
  const PlanarView& view = *settings.view;
  FovVideoVdpSettings metric;
  metric.geometry = {width_px, height_px, view.step_x * width_px, view.step_y * height_px, 1};
  metric.frames_per_second = settings.frames_per_second;
  metric.original_border = settings.original_border;
  metric.threads = settings.metric.threads;
  return std::make_unique<FovVideoVdpOfFrames>(metric, width_px, height_px);
}

// Averaged over frames is Q, over pixels the local difference in JOD.
double sequence_value_fovvideovdp(double mean) {
  return fovvideovdp_jod(mean);
}
double sequence_local_value_fovvideovdp(double mean) {
  constexpr double kNoDifference = 10;
  return kNoDifference - mean;
}

}  // namespace gazetrace
