// SPDX-License-Identifier: Apache-2.0
// What the headers of files state about a frame's gaze.
#pragma once

#include <string>

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// "state=measured u=0.5 v=0.5 ... event=fixation since_saccade_ns=84000000 no_gaze=0"; what is not known is left out.
// Gaze on a screen is a place, "u=0.5 v=0.5", and any other gaze a direction, "direction=0,0,-1".
std::string gaze_words(const GazeAtTime& gaze);

}  // namespace gazetrace
