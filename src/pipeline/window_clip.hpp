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
#include <map>
#include <memory>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"
#include "pipeline/judged_windows.hpp"
#include "pipeline/window_reference.hpp"

namespace gazetrace {

class WindowClip {
 public:
  // Keeps references to all, which must outlive it. `settings` accumulate nothing, or AccumulateMode::two_sided.
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

  // The rates of the fall-off `visible` by the last look, for this mean, where all frames are looked at alike: they can
  // share them. Empty for other fall-offs, and where view or gaze moves.
  [[nodiscard]] ImageGray shared_rates(double spp) const;
  // Whether the sampling of all frames follows from the same view and gaze.
  [[nodiscard]] bool is_steady() const;
  [[nodiscard]] const JudgedWindows& windows() const { return windows_; }
  [[nodiscard]] double share_of_frame() const;
  [[nodiscard]] double counted_px() const;  // of a frame
  // How many renderings of a still a look is the mean of. 1 for sequences.
  [[nodiscard]] std::size_t stills_a_look() const;
  [[nodiscard]] TraceStats stats() const;  // of all samples, the reference's among them

 private:
  [[nodiscard]] const FrameRequest& first_looked_at() const;
  [[nodiscard]] const FrameRequest& first() const { return judged_.runs.front().front(); }
  // Samples a pixel that every pixel of a frame expects.
  [[nodiscard]] ImageGray expected_spp(const FrameRequest& request, double spp, std::uint64_t round);
  [[nodiscard]] ImageGray pilot_rates(const FrameRequest& request, FrameSettings settings);
  // What the whole frame of this number learns of its light, which windows of it are rendered with.
  [[nodiscard]] std::shared_ptr<const LearnedLight> light_of(std::int32_t frame);
  // One picture a judged frame.
  [[nodiscard]] std::vector<ImageRgb> look_at(std::size_t window, const FrameSettings& settings);
  void render_around();
  void show_around();
  // The frame with these windows, as it is shown, cd/m2. `index` counts the judged frames.
  [[nodiscard]] ImageGray shown(const std::vector<ImageRgb>& windows, std::size_t index) const;
  [[nodiscard]] double measured_q(const JudgedFrames& judged, const WindowPictures& pictures) const;
  // Of a judged frame: which of the references is its own, and which of the pictures around the windows.
  [[nodiscard]] std::size_t reference_of(std::size_t index) const { return judged_.view_moves ? index : 0; }
  [[nodiscard]] std::size_t around_of(std::size_t index) const;

  PathTracer& tracer_;
  const JudgedFrames& judged_;
  const FrameSettings& settings_;
  const ColorPipeline& color_;
  TraceStats stats_;
  std::map<std::int32_t, const FrameRequest*> requests_;  // of whole frames, all that windows are traced of
  KnownLight last_light_;
  std::map<std::int32_t, std::shared_ptr<const LearnedLight>> light_;  // by the frame
  std::size_t light_bytes_ = 0;                                        // of all of them
  JudgedWindows windows_;
  // What lies around the windows: of the first frame of each run or, at rest, of the first.
  struct Around {
    ImageRgb radiance;  // linear
    double exposure_ev = 0;
    ImageGray shown;  // cd/m2
  };
  std::vector<Around> around_;
  WindowReference reference_;
  std::vector<ImageGray> reference_shown_;  // cd/m2
  double reference_q_ = 0;
  ImageGray shared_rates_;
};

}  // namespace gazetrace
