// SPDX-License-Identifier: Apache-2.0
// What is seen of the error of a sequence that has no reference: judged by a replica of its error (replica_noise.hpp).
//
// In front of a picture that stands for the reference, one more rendering through `guided`, FovVideoVDP and FLIP are
// asked what they see of the replica if it were larger or smaller. The view must be at rest, so that one picture serves
// all frames: noise in it would hide the replica, above all noise that flickers.
#pragma once

#include <cstdint>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"
#include "pipeline/replica_noise.hpp"

namespace gazetrace {

class ReplicaClip {
 public:
  // Keeps references to all, which must outlive it. `settings` accumulate nothing, or AccumulateMode::two_sided.
  ReplicaClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
              const ColorPipeline& color);

  // Renders the picture that stands for the reference, unless the present one has at least half as many samples.
  // `round` chooses its samples.
  void look(double spp, std::uint64_t round);
  [[nodiscard]] const TraceStats& stats() const { return stats_; }
  [[nodiscard]] int looks() const { return looks_; }

  // How many frames at most are added up for one.
  [[nodiscard]] double most_summed() const;
  // Q of the whole sequence (fovvideovdp_jod()), if the squared error of frames, before any are added up, were `share`
  // times that of one rendering of `noise`. Error(input) where no judged frame has a gaze.
  [[nodiscard]] double q_at(const ReplicaNoise& noise, double share) const;
  // Mean FLIP of its frames as stills, at the view's pixels per degree.
  [[nodiscard]] double flip_at(const ReplicaNoise& noise, double share) const;

 private:
  [[nodiscard]] std::int64_t reach() const;  // how many frames after a frame are added to it
  // What is added up in a frame of the sequence, and another example of as many, with other samples.
  [[nodiscard]] SummedFrames summed_in(std::int64_t frame) const;
  [[nodiscard]] SummedFrames example_of(std::int64_t frame, std::size_t n) const;

  PathTracer& tracer_;
  const JudgedFrames& judged_;
  const FrameSettings& settings_;
  const ColorPipeline& color_;
  TraceStats stats_;
  int looks_ = 0;
  double spp_ = 0;
  ImageRgb base_;  // linear
  double exposure_ev_ = 0;
  ImageRgb code_;        // the base as it is shown
  ImageGray luminance_;  // of the display then, cd/m2
};

}  // namespace gazetrace
