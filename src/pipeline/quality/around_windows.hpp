// SPDX-License-Identifier: Apache-2.0
// What is shown around windows: one picture, whatever is seen in them.
#pragma once

#include <cstddef>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"
#include "pipeline/quality/judged_windows.hpp"
#include "pipeline/quality/window_reference.hpp"

namespace gazetrace {

class AroundWindows {
 public:
  // Renders one sample a pixel of the first frame of each run or, at rest, of the first; nothing where windows are the
  // whole frame. Adds what it takes to `stats`. Keeps references to all others, which must outlive it.
  AroundWindows(PathTracer& tracer, const JudgedFrames& judged, const JudgedWindows& windows,
                const FrameSettings& settings, const ColorPipeline& color, TraceStats& stats);

  // The pictures of the reference go into the windows before an exposure is chosen: what they show decides it.
  void expose(const WindowPictures& reference);
  // A frame with these windows, as it is shown, cd/m2. `index` counts the judged frames.
  [[nodiscard]] ImageGray shown(const std::vector<ImageRgb>& windows, std::size_t index) const;

 private:
  struct Picture {
    ImageRgb radiance;  // linear
    double exposure_ev = 0;
    ImageGray shown;  // cd/m2
  };
  // Which of the pictures a judged frame has.
  [[nodiscard]] std::size_t picture_of(std::size_t index) const;
  [[nodiscard]] ImageGray shown(const ImageRgb& radiance, double exposure_ev) const;

  const JudgedFrames& judged_;
  const JudgedWindows& windows_;
  const FrameSettings& settings_;
  const ColorPipeline& color_;
  std::vector<Picture> pictures_;
};

}  // namespace gazetrace
