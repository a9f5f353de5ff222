// SPDX-License-Identifier: Apache-2.0
// A frame as the sequence hands it over: whoever holds it holds its memory.
#pragma once

#include <memory>
#include <optional>

#include "gazetrace/color.hpp"
#include "gazetrace/compare.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace::python {

struct GivenFrame {
  FrameRequest request;
  RenderedFrame rendered;
  TimingRow row;
  std::shared_ptr<ColorPipeline> color;
  int threads = 0;
  // What comparisons must know of it besides.
  bool is_on_screen = false;     // a screen is known: the request's view is that of its viewer
  std::optional<Vec2d> gaze_px;  // gaze_true in continuous pixels of the frame
  GazeClass gaze_class = GazeClass::no_gaze;
  double frames_per_second = 0;
};

// Gaze in fractions of the screen as pixels of a frame that lies there, or fills it where that is not known.
Vec2d gaze_in_frame(const GazeAtTime& gaze, const std::optional<DisplayGeometry>& screen, const FrameRect& rect,
                    int width_px, int height_px);

// A sampling map and whatever it is a part of.
struct HeldMap {
  std::shared_ptr<const SamplingMap> map;
};

}  // namespace gazetrace::python
