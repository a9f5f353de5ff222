// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

// The display that converts positions: what the log states, overruled by what the user gave, with a warning where they
// differ. What the user gave is the recording's geometry from then on.
std::optional<DisplayGeometry> conversion_display(GazeLog& log, const GazeReadOptions& options,
                                                  const std::string& place);

}  // namespace gazetrace
