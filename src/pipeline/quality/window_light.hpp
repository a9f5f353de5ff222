// SPDX-License-Identifier: Apache-2.0
// The guiding fields of whole frames, which windows of them are rendered with.
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

  // Of the whole frame of this number; empty unless TraceSettings::guiding is set. Where the view rests, all frames
  // share one field. Adds the paths that it takes to `stats`.
  [[nodiscard]] std::shared_ptr<const GuidingField> of(std::int32_t frame, TraceStats& stats);

 private:
  PathTracer& tracer_;
  const JudgedFrames& judged_;
  const FrameSettings& settings_;
  std::map<std::int32_t, const FrameRequest*> requests_;  // of whole frames, all that windows are traced of
  TrainedField last_;
  std::map<std::int32_t, std::shared_ptr<const GuidingField>> kept_;  // by the frame
  std::size_t kept_bytes_ = 0;
};

}  // namespace gazetrace
