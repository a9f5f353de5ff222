// SPDX-License-Identifier: Apache-2.0
// Renders the frames of one sequence in their order, in the way that its settings ask for: each by itself, or beside
// those around it (JoinedFrames). Frames at rest share what they have learned of their light.
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "gazetrace/frame_renderer.hpp"
#include "pipeline/joined_frames.hpp"

namespace gazetrace {

class SequenceRenderer {
 public:
  // `counted` are the frames that get rows of their own in timing.csv. Keeps references to tracer and plan.
  SequenceRenderer(PathTracer& tracer, FrameSettings settings, const FramePlan& plan, std::set<std::int32_t> counted);
  SequenceRenderer(const SequenceRenderer&) = delete;
  SequenceRenderer& operator=(const SequenceRenderer&) = delete;

  RenderedFrame render(const FrameRequest& request);

 private:
  const FrameRenderer renderer_;
  std::optional<JoinedFrames> window_;
  KnownLight light_;
};

}  // namespace gazetrace
