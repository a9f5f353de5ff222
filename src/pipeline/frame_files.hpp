// SPDX-License-Identifier: Apache-2.0
// What becomes of a reconstructed frame: its exposure, its files, and its row of timing.csv.
#pragma once

#include <utility>

#include "core/stopwatch.hpp"
#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// Adds the wall time of a stage to `ms` and passes its result through.
template <class Stage>
auto timed(double& ms, Stage&& stage) {
  const Stopwatch watch;
  auto result = stage();
  ms += watch.elapsed_ms();
  return result;
}

struct RenderedFrame {
  SamplingMap map;
  Frame frame;
  double exposure_ev = 0;
};

// Where the eye was, for the frame's row.
void tell_gaze(const FrameRequest& request, TimingRow& row);

// Chooses the frame's exposure, then enhances its picture where that is asked for.
void expose(const FrameRequest& request, const PipelineSettings& settings, TemporalHistory& history,
            RenderedFrame& rendered, TimingRow& row);

// The map first and the linear picture last: the file that says a frame is there comes when everything else is.
void write_frame_files(const FrameRequest& request, const FramePlan& plan, const RenderedFrame& rendered,
                       const ColorPipeline& color, const PipelineSettings& settings, TimingRow& row,
                       SequenceResult& result);

}  // namespace gazetrace
