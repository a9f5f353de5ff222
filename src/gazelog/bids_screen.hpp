// SPDX-License-Identifier: Apache-2.0
// What BIDS' events.json says of the screen (StimulusPresentation).
#pragma once

#include "gazelog/bids_sidecars.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Of the positions; top_left where none is stated. Error(input) for one that cannot be read.
PositionOrigin bids_screen_origin(const Sidecars& events, const GazeReadOptions& options);
bool states_screen_origin(const Sidecars& events);

// Its size, distance and density into the raw, with warnings for what is taken otherwise than it stands there.
void read_bids_screen(const Sidecars& events, RawGaze& raw);

}  // namespace gazetrace
