// SPDX-License-Identifier: Apache-2.0
// What a frame will cost whose samples must fit into a time, where no frame before it tells.
//
// It is rendered at its full size with few samples and with more, which tells the fixed part of its time and what a
// further sample costs. (A sample costs less where more of them share a pixel.) Where `visible` puts samples they may
// cost more or less, which pilots tell.
#pragma once

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "pipeline/frame_cost.hpp"

namespace gazetrace {

struct Rehearsal {
  FrameCost cost;
  double learn_ms = 0;   // of learning the frame's light, which is no part of `cost`
  TraceStats discarded;  // all that was traced: no sample of the frame is among it
  double total_ms = 0;   // what the rehearsal took
};

// `settings` have a QualityTarget::time_s, and `history` is what the frame finds. What the rehearsal learns of the
// light is what the frame would learn, and is left in `known`.
Rehearsal rehearse(PathTracer& tracer, const FrameSettings& settings, const OutputSettings& output,
                   const FrameRequest& request, const TemporalHistory& history, KnownLight& known);

// The settings with a budget of samples in the place of a quality or a time.
FrameSettings with_budget(const FrameSettings& settings, double spp);

}  // namespace gazetrace
