// SPDX-License-Identifier: Apache-2.0
// The wall times of a frame's stages.
#pragma once

#include "core/stopwatch.hpp"
#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

// Adds the wall time of a stage to `ms` and passes its result through.
template <class Stage>
auto timed(double& ms, Stage&& stage) {
  const Stopwatch watch;
  auto result = stage();
  ms += watch.elapsed_ms();
  return result;
}

// `From` and `To` are StageTimes or TimingRow, which name these times alike.
template <class From, class To>
void add_times(const From& from, To& to) {
  to.plan_ms += from.plan_ms;
  to.guiding_ms += from.guiding_ms;
  to.pilot_ms += from.pilot_ms;
  to.trace_ms += from.trace_ms;
  to.guides_ms += from.guides_ms;
  to.reconstruct_ms += from.reconstruct_ms;
  to.temporal_ms += from.temporal_ms;
  to.exposure_ms += from.exposure_ms;
  to.layers_ms += from.layers_ms;
}

}  // namespace gazetrace
