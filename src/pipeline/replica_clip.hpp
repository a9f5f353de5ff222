// SPDX-License-Identifier: Apache-2.0
// What is seen of the error of a sequence that has no reference: judged by a replica of its error.
//
// Each judged frame is rendered twice, with samples that have nothing in common. Half the difference of the two, times
// the root of 2, has the variance of the error of one of them, its spectrum, its place in the picture, and is as new in
// every frame. FovVideoVDP is asked what of it is seen in front of a picture that stands for the reference: one more
// rendering, uniform, at a higher rate and through `guided`. The view must be at rest, so that this one serves all
// frames: noise in it would hide the replica, above all noise that flickers. What both renderings have in common, the
// bias of a filter, is not in the replica.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

class ReplicaClip {
 public:
  // Renders the judged frames with a budget of `spp` samples a pixel. `round` chooses the samples, which are those of
  // no frame of the sequence. `settings` accumulate nothing. Keeps references to `judged`, `settings` and `color`.
  ReplicaClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings, const ColorPipeline& color,
              double spp, std::uint64_t round);

  [[nodiscard]] const TraceStats& stats() const { return stats_; }
  // Q of the whole sequence (fovvideovdp_jod()), if the squared error were `share` times that of the pilot.
  // Error(input) where no judged frame has a gaze.
  [[nodiscard]] double q_at(double share) const;

 private:
  struct Judged {
    ImageRgb replica;  // linear
    std::optional<Vec2d> gaze_px;
  };

  [[nodiscard]] ImageGray shown(const ImageRgb& radiance) const;  // luminance of the display, cd/m2

  const JudgedFrames& judged_;
  const FrameSettings& settings_;
  const ColorPipeline& color_;
  TraceStats stats_;
  std::vector<std::vector<Judged>> runs_;
  ImageRgb base_;  // linear; stands for the reference
  double exposure_ev_ = 0;
  ImageGray reference_;  // the base as it is shown
};

}  // namespace gazetrace
