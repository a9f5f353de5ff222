// SPDX-License-Identifier: Apache-2.0
// What becomes of a rendered frame: its files.
#pragma once

#include <string>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// Writes the map first and the linear picture last, so that the file that marks a frame as complete appears when all
// others are there. `history` is history_text() of the frames behind this one; empty where it depends on no other. The
// files are added to those of `result`.
void write_frame_files(const FrameRequest& request, const FramePlan& plan, const RenderedFrame& rendered,
                       const ColorPipeline& color, const PipelineSettings& settings, const std::string& history,
                       TimingRow& row, SequenceResult& result);

}  // namespace gazetrace
