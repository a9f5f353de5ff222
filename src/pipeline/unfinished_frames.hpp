// SPDX-License-Identifier: Apache-2.0
// Frames that a run leaves for another one to finish: what the first half of the stages found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// Whether the frames of this run become such files, and not pictures.
bool leaves_unfinished(const PipelineSettings& settings);

// For settings that do: the file of a frame; and the settings' digest that it carries, empty where there is no file, or
// one of another kind.
std::string unfinished_file_name(const PipelineSettings& settings, std::int32_t frame);
std::string read_unfinished_digest(const PipelineSettings& settings, std::int32_t frame);

// Writes what was traced into the frame's file, which is added to `files`; the row gets the time and what is predicted.
void save_unfinished(std::int32_t frame, const TracedFrame& traced, const PipelineSettings& settings, TimingRow& row,
                     WrittenFiles& files);

// For a run that finishes (SequenceStage::finish): what another one has traced of a frame. Error(input) where it is of
// another size.
TracedFrame load_unfinished(const FrameRequest& request, const PipelineSettings& settings);
// Error(input) that names those of the frames that are not traced under these settings. Found out before anything is
// rendered: one frame that is not there ends the sequence.
void check_all_traced(const std::vector<std::int32_t>& frames, const PipelineSettings& settings);

}  // namespace gazetrace
