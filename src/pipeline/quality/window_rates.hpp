// SPDX-License-Identifier: Apache-2.0
// The rates that windows are sampled at: those that the sampling gives to their pixels in the whole frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"
#include "pipeline/quality/judged_windows.hpp"
#include "pipeline/quality/window_light.hpp"

namespace gazetrace {

// The rates of a look, in each window of each frame.
struct RatesOfLook {
  bool is_same = false;  // all frames share those of the number 0
  std::map<std::int32_t, std::vector<FrameRates>> by_number;

  [[nodiscard]] std::int32_t number(const FrameRequest& request) const { return is_same ? 0 : request.frame; }
  [[nodiscard]] const FrameRates& of(const FrameRequest& request, std::size_t window) const {
    return by_number.at(number(request))[window];
  }
};

class WindowRates {
 public:
  // Keeps references to all, which must outlive it.
  WindowRates(PathTracer& tracer, const JudgedFrames& judged, const JudgedWindows& windows,
              const FrameSettings& settings, WindowLight& light);

  // Whether the sampling of all frames follows from the same view and gaze.
  [[nodiscard]] bool is_steady() const;
  // Of all judged frames and those that they read, for `spp` samples a pixel on average. `round` chooses the samples of
  // pilots, which are added to `stats`.
  [[nodiscard]] RatesOfLook of_look(double spp, std::uint64_t round, TraceStats& stats);
  // The rates of a pilot by the last look, brought to this mean. Empty for other samplings, and where
  // frames are not steady.
  [[nodiscard]] ImageGray shared(double spp) const;

 private:
  // Samples a pixel that every pixel of a frame expects.
  [[nodiscard]] ImageGray expected_spp(const FrameRequest& request, double spp, std::uint64_t round, TraceStats& stats);
  [[nodiscard]] ImageGray pilot_rates(const FrameRequest& request, FrameSettings settings, TraceStats& stats);
  [[nodiscard]] ImageGray sum_of_pilots(const FrameRequest& request, FrameSettings settings, TraceStats& stats);

  PathTracer& tracer_;
  const JudgedFrames& judged_;
  const JudgedWindows& windows_;
  const FrameSettings& settings_;
  WindowLight& light_;
  ImageGray shared_;
};

}  // namespace gazetrace
