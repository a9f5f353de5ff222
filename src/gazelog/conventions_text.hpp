// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// The conclusions and their evidence in words for people: about the time, other facts of the file, the places, and the
// eye. These words are never parsed again.
std::vector<GazeFact> facts_in_words(const RawGaze& raw, const Conventions& conventions);

}  // namespace gazetrace
