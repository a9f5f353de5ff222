// SPDX-License-Identifier: Apache-2.0
// For sequences whose frames depend on those before them: checks whether the parts are what a single run would have
// made.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "gazetrace/output.hpp"

namespace gazetrace {

// The frames of the sequence in order, each with the part that it belongs to. A missing frame has the part that should
// have rendered it, or nullptr.
using FrameOwners = std::map<std::int32_t, const RunPart*>;

// A history is determined, bit for bit, by the settings and the frames that went into it, so comparing lists of frames
// is enough. Error(input) for the first part that began with another history than a single run would have had there; a
// warning where it began with the history of only the last few frames before it.
void check_histories(const FrameOwners& frames, Warnings& warnings);

}  // namespace gazetrace
