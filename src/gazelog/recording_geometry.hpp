// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Takes the size of the display that holds for the rows that are read; where it changes between them, adds a fault.
void settle_display(RawGaze& raw);

// The display by which positions are converted: what the log states, overruled by what the user gave, with a warning
// where they differ. What the user gave becomes the geometry of the recording, `c.recording_geometry`.
std::optional<Concluded<DisplayGeometry>> conversion_display(const RawGaze& raw, const GazeReadOptions& options,
                                                             Conventions& c);

}  // namespace gazetrace
