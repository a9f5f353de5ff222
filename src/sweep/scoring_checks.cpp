// SPDX-License-Identifier: Apache-2.0
// Checks that the metrics of a sweep can score a test, before hours are spent on rendering it.
#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/error.hpp"
#include "gazetrace/flicker.hpp"
#include "sweep/frames.hpp"
#include "sweep/scorer.hpp"

namespace gazetrace {
namespace {

// The largest picture that is tried on metrics of single frames. What they refuse are small pictures.
MetricPicture small_picture(int width_px, int height_px) {
  constexpr int kLargeEnough = 256;
  const bool is_large = std::min(width_px, height_px) >= kLargeEnough;
  MetricPicture picture;
  picture.light = is_large ? ImageRgb(kLargeEnough, kLargeEnough) : ImageRgb(width_px, height_px);
  const auto count = static_cast<float>(picture.light.pixels.size());
  for (std::size_t i = 0; i < picture.light.pixels.size(); ++i) {
    const float value = (static_cast<float>(i) + 0.5F) / count;
    picture.light.pixels[i] = {value, value, value};
  }
  picture.code = picture.light;
  return picture;
}

}  // namespace

void check_scoring(const SweepMeasure& sweep, const SweepTest& test) {
  const std::vector<ResultFrame> frames = sweep_frames(test.plan, test.pipeline.foveation, sweep.leave_out_s);
  const ComparisonSettings settings = comparison_of(sweep.comparison, test.plan, frames, test.pipeline.fps);
  if (std::all_of(frames.begin(), frames.end(), [](const ResultFrame& frame) { return frame.event == "start"; })) {
    throw Error(
        ErrorKind::usage, "leave-out",
        fmt::format("all {} frames lie in the first {:g} s, and none is scored", frames.size(), sweep.leave_out_s),
        "leave out less, or render more frames");
  }
  if (settings.metrics.empty()) {
    throw Error(ErrorKind::usage, "metrics", "all of these need gaze, and no frame has one",
                "add a [[gaze]], or a metric that needs none");
  }
  const FrameRequest& request = test.plan.frames.front();
  const double rate =
      static_cast<double>(test.pipeline.fps.numerator) / static_cast<double>(test.pipeline.fps.denominator);
  const MetricPicture picture = small_picture(request.width_px, request.height_px);
  const std::vector<MetricInfo>& of_frames = metrics();
  for (const std::string& name : settings.metrics) {
    const bool is_of_a_second = name == "flicker" || name == "temporal_bias";
    if (is_of_a_second && frames.size() < static_cast<std::size_t>(frames_of_a_second(rate))) {
      throw Error(ErrorKind::usage, name,
                  fmt::format("looks at whole seconds; {} frames at {:g} a second are less", frames.size(), rate),
                  "render more frames, or leave the metric out");
    }
    // Where one end of the range of exposures is found from the reference, it is not known yet whether it fits the
    // other.
    const FlipExposureSettings& flip = settings.metric.hdr_flip;
    const bool is_open = name == "hdr_flip" && flip.start_ev.has_value() != flip.stop_ev.has_value();
    const auto is_it = [&](const MetricInfo& info) { return info.name == name; };
    if (!is_open && std::any_of(of_frames.begin(), of_frames.end(), is_it)) {
      measure(name, picture, picture, settings.metric);
    }
  }
  const Comparison comparison(settings, request.width_px, request.height_px);
}

}  // namespace gazetrace
