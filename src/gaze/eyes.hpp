// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// Makes one gaze of the rows of one time, as options.eye says, and keeps both eyes in `log.eyes`. The rows are ordered,
// and there is at most one of each eye at a time.
void choose_eyes(GazeLog& log, const GazeReadOptions& options);

}  // namespace gazetrace
