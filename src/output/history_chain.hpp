// SPDX-License-Identifier: Apache-2.0
// Whether parts of a sequence whose frames depend on those before them are what one run would have made.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "gazetrace/output.hpp"

namespace gazetrace {

// The frames of the sequence in order with the parts they belong to; for missing ones nullptr, or the part that
// promised them.
using FrameOwners = std::map<std::int32_t, const RunPart*>;

// Frames and settings decide a history to the bit, so that it is known by the frames that it has passed. Error(input)
// for the first part that found another one than a single run would have handed it; a warning where it found that of
// the last few frames before it.
void check_histories(const FrameOwners& frames, Warnings& warnings);

}  // namespace gazetrace
