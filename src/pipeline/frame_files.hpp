// SPDX-License-Identifier: Apache-2.0
// What becomes of a rendered frame: its files.
#pragma once

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// Writes the map first and the linear picture last, so that the file that marks a frame as complete appears when all
// others are there. The files are added to those of `result`.
void write_frame_files(const FrameRequest& request, const FramePlan& plan, const RenderedFrame& rendered,
                       const ColorPipeline& color, const PipelineSettings& settings, TimingRow& row,
                       SequenceResult& result);

}  // namespace gazetrace
