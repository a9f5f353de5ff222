// SPDX-License-Identifier: Apache-2.0
// What headers say of a frame's gaze.
#pragma once

#include <string>

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// "state=measured u=0.5 v=0.5 ... event=fixation since_saccade_ns=84000000 no_gaze=0"; without what is not known.
std::string gaze_words(const GazeAtTime& gaze);

}  // namespace gazetrace
