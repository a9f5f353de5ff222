// SPDX-License-Identifier: Apache-2.0
// What a finished run says of itself.
#pragma once

#include <string>

#include "cli/inputs.hpp"
#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// Frames, mean time by stage, samples and speed; several lines.
std::string summary_text(const SequenceResult& result, double wall_s);
std::string summary_json(const SequenceResult& result, const Inputs& inputs, const PipelineSettings& settings,
                         double wall_s);

// Frames without gaze, clamped values, samples that were not finite with the command that replays them.
Warnings result_warnings(const SequenceResult& result, const FramePlan& plan);

}  // namespace gazetrace
