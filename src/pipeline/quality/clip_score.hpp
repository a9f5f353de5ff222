// SPDX-License-Identifier: Apache-2.0
// What FovVideoVDP sees of a whole sequence, by the frames that are judged for it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "gazetrace/color.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

struct ClipScoreSettings {
  double frames_per_second = 0;  // of a sequence of more than one frame
  // What is added up at rest grows until a window has filled: the first frames then stand for themselves alone.
  bool fills = false;
  ImageGray weights;  // FovVideoVdpSettings::pooling_weights
  int threads = 0;
};

// The luminance (cd/m2) of a judged frame as it is shown, and that of its reference; `index` counts the frames of all
// runs.
using ShownFrame = std::function<ImageGray(std::size_t index)>;
using ReferenceFrame = std::function<const ImageGray&(std::size_t index)>;

// Q of the sequence (fovvideovdp_jod()). Error(input) where no judged frame has a gaze.
double clip_q(const JudgedFrames& judged, const ReferenceFrame& reference, const ShownFrame& shown,
              const ClipScoreSettings& settings);

// Code values 0..1 of what a display gets: in 8 bits, as `gazetrace compare` reads pictures.
ImageRgb shown_code(const ImageRgb& radiance, const ColorPipeline& color, double exposure_ev, int threads);

// Where a frame is looked at, in its pixels; empty: nowhere.
std::optional<Vec2d> looked_at_px(const FrameRequest& request);

}  // namespace gazetrace
