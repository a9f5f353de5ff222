// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// What was concluded from what, for people: of the time, what else the file says, of the places, and of the eye.
// Nothing reads these words again.
std::vector<GazeFact> facts_in_words(const RawGaze& raw, const Conventions& conventions);

}  // namespace gazetrace
