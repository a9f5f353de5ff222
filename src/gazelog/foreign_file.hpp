// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

// Throws Error(input) for a file that no reader of gaze understands, naming what it is and the way out: binary
// recordings, archives, JSON, and texts that are no table. For files that no format claims.
void refuse_foreign_file(const GazeFile& file);

}  // namespace gazetrace
