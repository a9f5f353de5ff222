// SPDX-License-Identifier: Apache-2.0
// Renders the frames of one sequence in their order, in the way that its settings ask for: each by itself, beside those
// around it (FrameWindow), or within a time (TimeBudget). Frames at rest share what they have learned of their light.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "pipeline/frame_window.hpp"
#include "pipeline/time_budget.hpp"

namespace gazetrace {

class SequenceRenderer {
 public:
  // `counted` are the frames that get rows of their own in timing.csv. Keeps references to tracer, plan and output.
  SequenceRenderer(PathTracer& tracer, FrameSettings settings, const FramePlan& plan, std::set<std::int32_t> counted,
                   const OutputSettings& output);
  SequenceRenderer(const SequenceRenderer&) = delete;
  SequenceRenderer& operator=(const SequenceRenderer&) = delete;

  // `history` is as for FrameRenderer::render().
  RenderedFrame render(const FrameRequest& request, TemporalHistory& history);
  // The two halves of a frame by itself.
  TracedFrame trace(const FrameRequest& request);
  [[nodiscard]] RenderedFrame finish(const FrameRequest& request, TracedFrame traced, TemporalHistory& history) const;

  // TimeBudget's, for the row of a frame; nothing where there is no time to keep to.
  void learn(TimingRow& row);
  void check(const TimingRow& row);
  [[nodiscard]] std::string warning() const;

 private:
  PathTracer& tracer_;
  const FrameSettings settings_;
  const FrameRenderer renderer_;
  std::optional<FrameWindow> window_;
  std::optional<TimeBudget> time_budget_;
  KnownLight light_;
};

}  // namespace gazetrace
