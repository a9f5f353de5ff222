// SPDX-License-Identifier: Apache-2.0
// What the frames of a sequence know of those before them: the history that the first one finds (starting_history()),
// and which frames are in that of the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// history_text() of what each frame of the plan finds; empty texts where frames do not depend on each other.
// `history` is what the plan's first frame finds.
std::vector<std::string> expected_histories(const FramePlan& plan, const PipelineSettings& settings,
                                            const TemporalHistory& history);

// Throws Error(input) where frames are to be made, in ascending order, and `history` is hollow, see
// starting_history().
void check_history_for(const std::vector<std::int32_t>& frames, const PipelineSettings& settings,
                       const TemporalHistory& history);

}  // namespace gazetrace
