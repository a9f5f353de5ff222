// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

// For files that no format claims. Throws Error(input) naming what the file is and the way out: binary recordings,
// archives, JSON.
void refuse_foreign_file(const GazeFile& file);
// Likewise for texts that are no table.
void refuse_prose(const GazeFile& file);

}  // namespace gazetrace
