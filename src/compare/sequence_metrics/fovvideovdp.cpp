// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP of luminance; metrics/fovvideovdp.cpp has the metric.
#include <cmath>

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

// How far the middle lies beside the eye's perpendicular, from one border and half the size. What rounding leaves of
// nothing is nothing, so that pictures in the middle score to the bit as the metric's authors have it.
double middle_m(double border_m, double half_m) {
  constexpr double kRounding = 1e-9;
  const double middle = border_m + half_m;
  return std::fabs(middle) < kRounding * std::fabs(half_m) ? 0 : middle;
}

}  // namespace

std::unique_ptr<SequenceMetric> make_fovvideovdp(const ComparisonSettings& settings, int width_px, int height_px) {
  // The metric takes a picture to fill its display: a display of the picture's own pixels, size and place. Distance 1
  // m.
  const PlanarView& view = *settings.view;
  const double width_m = view.step_x * width_px;
  const double height_m = view.step_y * height_px;
  FovVideoVdpSettings metric;
  metric.geometry = {
      width_px, height_px, width_m, height_m, 1, middle_m(view.left, width_m / 2), middle_m(view.top, -height_m / 2)};
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
