// SPDX-License-Identifier: Apache-2.0
// What becomes of one frame of a sequence: its files, and its row of timing.csv.
#pragma once

#include "gazetrace/pipeline.hpp"
#include "pipeline/resume.hpp"
#include "pipeline/sequence_renderer.hpp"

namespace gazetrace {

// What a sequence is made from, and who is told of it.
struct SequenceInputs {
  const FramePlan& plan;
  const ColorPipeline& color;
  const PipelineSettings& settings;
  const PipelineObserver& observer;
};

// Makes a frame that is not skipped, by the stages that the run does. Its files are those of `result`, and its row
// lacks what the choice of a rate took. Error(interrupted) leaves row and history as they were, and `result` without
// files: a frame is given up only while it is traced. Where the run leaves frames unfinished, what is returned is
// empty.
RenderedFrame make_frame(const SequenceInputs& inputs, const FrameRequest& request, FrameWork work,
                         SequenceRenderer& renderer, TemporalHistory& history, TimingRow& row, SequenceResult& result);

}  // namespace gazetrace
