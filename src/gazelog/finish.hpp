// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

// What holds for a log of any format: at least one sample, ordered times, no two rows of one eye at one time, and one
// gaze of both eyes a time.
void finish_log(GazeLog& log, const GazeReadOptions& options);

}  // namespace gazetrace
