// SPDX-License-Identifier: Apache-2.0
// A replica of a frame's error, made without a reference.
//
// The frame is rendered four times with samples that have nothing in common. Three sums of the four, with signs that
// cancel what they have in common and are orthogonal to each other (the rows of a Hadamard matrix), show noise alone.
// Each has the variance of the error of one rendering, its spectrum and its place in the picture, and as few outliers
// as a mean of four renderings has, which is what it mostly stands for: the error of a frame of four times the samples.
// In the frames of a clip the three take turns and are moved by a few pixels, so that the noise is new in every frame
// without being rendered anew. What all renderings have in common, such as the bias of a filter, is not in them.
#pragma once

#include <array>
#include <cstdint>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

// The settings of a discarded rendering: uniform settings with a budget of `spp` samples a pixel, and samples that are
// those of no frame of the run.
FrameSettings discarded_settings(const FrameSettings& settings, double spp, std::uint64_t tag);

class ReplicaNoise {
 public:
  static constexpr int kRenderings = 4;

  // Renders `request` with a budget of `spp` samples a pixel; `round` chooses the samples.
  ReplicaNoise(PathTracer& tracer, const FrameRequest& request, const FrameSettings& settings, double spp,
               std::uint64_t round);

  [[nodiscard]] const TraceStats& stats() const { return stats_; }
  // `picture` with the error of the clip's frame `index`, if its square were `share` times that of one rendering. What
  // would be less than no light is 0.
  [[nodiscard]] ImageRgb noisy(const ImageRgb& picture, double share, std::size_t index) const;

 private:
  TraceStats stats_;
  std::array<ImageRgb, kRenderings - 1> noise_;  // linear
  int threads_ = 0;
};

}  // namespace gazetrace
