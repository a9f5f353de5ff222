// SPDX-License-Identifier: Apache-2.0
// A replica of a frame's error, made without a reference.
//
// The frame is rendered four times with samples that have nothing in common. Three sums of the four, with signs that
// cancel what they have in common and are orthogonal to each other (the rows of a Hadamard matrix), show noise alone.
// Each has the variance of the error of one rendering, its spectrum and its place in the picture, and as few outliers
// as a mean of four renderings has, which is what it mostly stands for: the error of a frame of four times the samples.
// In the frames of a clip the three take turns and are moved by a few pixels, so that the noise is new in every frame
// without being rendered anew. Where the samples of several frames are added up (AccumulateMode::two_sided of a view at
// rest), the replica has the power of their mean, and changes from frame to frame as that does. What all renderings
// have in common, such as the bias of a filter, is not in them.
#pragma once

#include <array>
#include <cstdint>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

// The settings of a discarded rendering: uniform settings with a budget of `spp` samples a pixel, and samples that are
// those of no frame of the run.
FrameSettings discarded_settings(const FrameSettings& settings, double spp, std::uint64_t tag);

// The frames whose samples, counted alike, make a picture: `count` of them from `first` on.
struct SummedFrames {
  std::size_t first = 0, count = 1;
};

class ReplicaNoise {
 public:
  static constexpr int kRenderings = 4;

  // Of renderings that are there, all of one size.
  ReplicaNoise(const std::array<ImageRgb, kRenderings>& pictures, int threads);
  // Renders `request` with a budget of `spp` samples a pixel; `round` chooses the samples.
  ReplicaNoise(PathTracer& tracer, const FrameRequest& request, const FrameSettings& settings, double spp,
               std::uint64_t round);

  // Divides rare light as more samples would. A picture of many more samples than the four renderings has more of it,
  // each speck fainter, where one here may be brighter than a display. A pixel in which one of the four saw much more
  // than the others becomes so many pixels near it, of random sign, with the same sum of squares. The rest stays in its
  // place, where edges may hide it.
  void divide(int pixels);

  [[nodiscard]] const TraceStats& stats() const { return stats_; }
  // `picture` with the error of the mean of these frames of a clip, if its square were in each of them `share` times
  // that of one rendering. What would be less than no light is 0.
  [[nodiscard]] ImageRgb noisy(const ImageRgb& picture, double share, const SummedFrames& frames) const;

 private:
  // How much there is of each of the three, and how they are moved.
  struct Mixture {
    std::array<double, kRenderings - 1> weights{};
    std::size_t turn = 0;
  };
  [[nodiscard]] Mixture mixture(const SummedFrames& frames) const;

  TraceStats stats_;
  std::array<ImageRgb, kRenderings - 1> noise_;  // linear
  Image<std::uint8_t> rare_;                     // 1 where divide() acts
  int threads_ = 0;
};

}  // namespace gazetrace
