// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/clip_score.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"

namespace gazetrace {

std::optional<Vec2d> looked_at_px(const FrameRequest& request) {
  if (!request.gaze_direction_true || request.gaze_true.no_gaze) {
    return std::nullopt;
  }
  return request.view.pixel(*request.gaze_direction_true);
}

ImageRgb shown_code(const ImageRgb& radiance, const ColorPipeline& color, double exposure_ev, int threads) {
  constexpr int kBits = 8;
  constexpr float kMostCode = 255;
  const DisplayImage image = color.apply(radiance, exposure_ev, kBits, threads);
  ImageRgb code(radiance.width_px, radiance.height_px);
  const auto width = static_cast<std::size_t>(radiance.width_px);
  parallel_for(static_cast<std::size_t>(radiance.height_px), threads, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      const std::uint8_t* bytes = &image.bytes[3 * i];
      code.pixels[i] = {static_cast<float>(bytes[0]) / kMostCode, static_cast<float>(bytes[1]) / kMostCode,
                        static_cast<float>(bytes[2]) / kMostCode};
    }
  });
  return code;
}

double clip_q(const JudgedFrames& judged, const ReferenceFrame& reference, const ShownFrame& shown,
              const ClipScoreSettings& settings) {
  const PlanarView& view = judged.runs.front().front().view;
  FovVideoVdpSettings metric_settings;
  metric_settings.geometry = fovvideovdp_geometry(view);
  metric_settings.frames_per_second = judged.sequence_frames == 1 ? 0 : settings.frames_per_second;
  metric_settings.pooling_weights = settings.weights;
  metric_settings.threads = settings.threads;
  // The first frames of the sequence stand for themselves, those that have all before them in view for all the others.
  // What is added up at rest grows until a window has filled: the runs in the middle and at the end show that.
  double early = 0;
  double late = 0;
  double early_frames = 0;
  double late_frames = 0;
  std::size_t index = 0;
  for (const std::vector<FrameRequest>& run : judged.runs) {
    FovVideoVdp metric(metric_settings, view.width_px, view.height_px);
    for (std::size_t i = 0; i < run.size(); ++i, ++index) {
      const ImageGray seen = shown(index);
      const std::optional<Vec2d> gaze = looked_at_px(run[i]);
      // Where a window still fills, the first run stands for itself alone.
      const bool fills = settings.fills && judged.runs.size() > 1 && &run == &judged.runs.front();
      const bool is_late = !fills && i + 1 >= static_cast<std::size_t>(metric.taps());
      if (!gaze || (!is_late && &run != &judged.runs.front())) {
        metric.prime(reference(index), seen);
        continue;
      }
      (is_late ? late : early) += metric.add(reference(index), seen, gaze).q;
      (is_late ? late_frames : early_frames) += 1;
    }
  }
  if (!(early_frames + late_frames > 0)) {
    throw Error(ErrorKind::input, "`target-jod`", "none of the frames by which the sequence is judged has a gaze",
                "check `gaze-start` and `gaze-offset`");
  }
  if (!(late_frames > 0)) {
    return early / early_frames;
  }
  const double rest = std::max(0.0, judged.sequence_frames - early_frames);
  return (early + rest * late / late_frames) / (early_frames + rest);
}

}  // namespace gazetrace
