// SPDX-License-Identifier: Apache-2.0
// What the events.json of BIDS says about the screen (StimulusPresentation).
#pragma once

#include "gazelog/bids_sidecars.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// The origin of the positions; top_left where none is stated. Throws Error(input) for an origin that cannot be read.
PositionOrigin bids_screen_origin(const Sidecars& events, const GazeReadOptions& options);
bool states_screen_origin(const Sidecars& events);

// Writes the size, distance and pixel density of the screen into the raw gaze, with warnings for values that are not
// taken as they stand in the file.
void read_bids_screen(const Sidecars& events, RawGaze& raw);

}  // namespace gazetrace
