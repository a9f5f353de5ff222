// SPDX-License-Identifier: Apache-2.0
// How a sequence is divided among the tasks of an array job.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// The frames of the chunk that the job asks for. All tasks find the same borders: these follow from the plan alone, and
// the first task that renders has written them down. Error(nothing_to_do) for a chunk without frames. `whole`: the plan
// of all frames. `decision` says in words what the borders follow from.
std::vector<std::int32_t> frames_of_chunk(const JobSettings& job, const FramePlan& whole, std::string& decision);

// The borders to be written down; an empty path where they are, or where there is nothing to balance or no output.
ChunkBorders chunk_borders(const JobSettings& job, const FramePlan& whole);

}  // namespace gazetrace
