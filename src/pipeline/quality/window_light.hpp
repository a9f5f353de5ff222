// SPDX-License-Identifier: Apache-2.0
// What whole frames learn of their light, which windows of them are rendered with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

class WindowLight {
 public:
  // Keeps references to all, which must outlive it.
  WindowLight(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings);

  // Of the whole frame of this number; empty unless TraceSettings::learn_light is set. Where the view rests, all frames
  // are lit alike, and learn once. Adds the paths that it takes to `stats`.
  [[nodiscard]] std::shared_ptr<const LearnedLight> of(std::int32_t frame, TraceStats& stats);

 private:
  PathTracer& tracer_;
  const JudgedFrames& judged_;
  const FrameSettings& settings_;
  std::map<std::int32_t, const FrameRequest*> requests_;  // of whole frames, all that windows are traced of
  KnownLight last_;
  std::map<std::int32_t, std::shared_ptr<const LearnedLight>> kept_;  // by the frame
  std::size_t kept_bytes_ = 0;
};

}  // namespace gazetrace
