// SPDX-License-Identifier: Apache-2.0
// What becomes of a rendered frame: its files.
#pragma once

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// The map first and the linear picture last: the file that says a frame is there comes when everything else is.
void write_frame_files(const FrameRequest& request, const FramePlan& plan, const RenderedFrame& rendered,
                       const ColorPipeline& color, const PipelineSettings& settings, TimingRow& row,
                       SequenceResult& result);

}  // namespace gazetrace
