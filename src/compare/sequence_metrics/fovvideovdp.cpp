// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP of luminance. The metric itself is in metrics/fovvideovdp.cpp.
#include <cmath>

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

// How far the middle lies off the perpendicular from the eye, from one border and half the size. A rounding error
// becomes exactly 0, so that a centered picture scores bit for bit as in the geometry of the metric's authors.
double middle_m(double border_m, double half_m) {
  constexpr double kRounding = 1e-9;
  const double middle = border_m + half_m;
  return std::fabs(middle) < kRounding * std::fabs(half_m) ? 0 : middle;
}

}  // namespace

std::unique_ptr<SequenceMetric> make_fovvideovdp(const ComparisonSettings& settings, int width_px, int height_px) {
  // The metric assumes that a picture fills its display, so it gets a display of the picture's own pixels, size and
  // position, at a distance of 1 m.
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

// The mean over frames is that of Q, the mean over pixels that of the local difference in JOD.
double sequence_value_fovvideovdp(double mean) {
  return fovvideovdp_jod(mean);
}
double sequence_local_value_fovvideovdp(double mean) {
  constexpr double kNoDifference = 10;
  return kNoDifference - mean;
}

}  // namespace gazetrace
