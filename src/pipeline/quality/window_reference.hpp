// SPDX-License-Identifier: Apache-2.0
// The reference of the windows that a sequence is judged in: many raw samples, in two halves that have nothing in
// common, so that their difference tells the reference's own error.
//
// Around what counts, where only the metric's coarser bands look, a pixel gets a quarter of the samples. (Samples that
// follow the visible noise, as those of AdaptiveSampling do, did not pay: FovVideoVDP saw as much of their
// error.)
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/plan.hpp"
#include "pipeline/quality/judged_windows.hpp"

namespace gazetrace {

// Of frames one after the other, those of all runs: what each shows in every window, linear.
using WindowPictures = std::vector<std::vector<ImageRgb>>;

class WindowReference {
 public:
  // The guiding field of the whole frame of a request.
  using LightOf = std::function<std::shared_ptr<const GuidingField>(const FrameRequest& request)>;

  // Keeps references to all, which must outlive it. `views`: frames that are each to have a reference. Without
  // `light_of` bounces follow the BSDF alone.
  WindowReference(PathTracer& tracer, const JudgedWindows& windows, std::vector<const FrameRequest*> views,
                  const FrameSettings& settings, LightOf light_of = {});

  // More samples: so many a pixel in all, a mean over the windows.
  void refine(double spp);
  [[nodiscard]] double spp() const { return spp_; }
  // Of each view.
  [[nodiscard]] const WindowPictures& pictures() const { return mean_; }
  // Pictures that are as far from these as these are from the truth, on average.
  [[nodiscard]] WindowPictures as_far_off() const;
  [[nodiscard]] const TraceStats& stats() const { return stats_; }
  // In every window: a pixel's share of the samples, 1 on average over all windows.
  [[nodiscard]] const std::vector<ImageGray>& rates() const { return rates_; }

 private:
  void add_samples(double spp, std::size_t half);

  PathTracer& tracer_;
  const JudgedWindows& windows_;
  std::vector<const FrameRequest*> views_;
  const FrameSettings& settings_;
  LightOf light_of_;
  std::vector<ImageGray> rates_;
  std::array<WindowPictures, 2> halves_;
  WindowPictures mean_;
  double spp_ = 0;
  TraceStats stats_;
};

}  // namespace gazetrace
