// SPDX-License-Identifier: Apache-2.0
// What is seen of the error of a sequence, measured in windows of some of its frames before it is rendered.
//
// In a few windows (judged_windows.hpp) what the sequence would show there is rendered, with samples that are
// discarded, beside a reference of many raw samples: all that a filter does wrong is in the difference, its bias as
// well. Around the windows both show the same picture, and FovVideoVDP counts the windows for the areas that they stand
// for. Where the view rests, one reference serves all frames. Where it moves, each judged frame has its own, which is
// dear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"
#include "pipeline/quality/around_windows.hpp"
#include "pipeline/quality/judged_windows.hpp"
#include "pipeline/quality/window_light.hpp"
#include "pipeline/quality/window_rates.hpp"
#include "pipeline/quality/window_reference.hpp"

namespace gazetrace {

class WindowClip {
 public:
  // Keeps references to all, which must outlive it.
  WindowClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings, const ColorPipeline& color);
  WindowClip(const WindowClip&) = delete;
  WindowClip& operator=(const WindowClip&) = delete;

  // The frames as they would be with `spp` samples a pixel on average. `round` chooses the samples.
  WindowPictures look(double spp, std::uint64_t round);
  // Q of the whole sequence (fovvideovdp_jod()) with these pictures; the reference's own error is taken off.
  [[nodiscard]] double q_of(const WindowPictures& pictures) const;

  // WindowReference::refine()
  void refine(double spp);
  [[nodiscard]] double reference_spp() const { return reference_.spp(); }
  [[nodiscard]] double reference_q() const { return reference_q_; }  // Q of its own error

  // The rates of a pilot by the last look, for this mean, where all frames are looked at alike: they can
  // share them. Empty for other samplings, and where view or gaze moves.
  [[nodiscard]] ImageGray shared_rates(double spp) const { return rates_.shared(spp); }
  // Whether the sampling of all frames follows from the same view and gaze.
  [[nodiscard]] bool is_steady() const { return rates_.is_steady(); }
  [[nodiscard]] const JudgedWindows& windows() const { return windows_; }
  [[nodiscard]] double share_of_frame() const;
  [[nodiscard]] double counted_px() const;  // of a frame
  // How many renderings of a still a look is the mean of. 1 for sequences.
  [[nodiscard]] std::size_t stills_a_look() const;
  [[nodiscard]] TraceStats stats() const;  // of all samples, the reference's among them

 private:
  [[nodiscard]] const FrameRequest& first_looked_at() const;
  [[nodiscard]] const FrameRequest& first() const { return judged_.runs.front().front(); }
  // One picture a judged frame.
  [[nodiscard]] std::vector<ImageRgb> look_at(std::size_t window, const FrameSettings& settings);
  // Appends what the frames of a plan show.
  void render(const FramePlan& plan, const FrameSettings& settings, std::vector<ImageRgb>& pictures);
  [[nodiscard]] double measured_q(const JudgedFrames& judged, const WindowPictures& pictures) const;
  // Of a judged frame: which of the references is its own.
  [[nodiscard]] std::size_t reference_of(std::size_t index) const { return judged_.view_moves ? index : 0; }

  PathTracer& tracer_;
  const JudgedFrames& judged_;
  const FrameSettings& settings_;
  TraceStats stats_;  // of all but the reference's samples
  WindowLight light_;
  JudgedWindows windows_;
  WindowRates rates_;
  AroundWindows around_;
  WindowReference reference_;
  std::vector<ImageGray> reference_shown_;  // cd/m2
  double reference_q_ = 0;
};

}  // namespace gazetrace
