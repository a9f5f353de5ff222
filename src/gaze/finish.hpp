// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// What holds for a log of any format: at least one sample, ordered times, no two rows of one eye at one time, and both
// eyes of one time merged to their mean.
void finish_log(GazeLog& log, UnorderedPolicy unordered);

}  // namespace gazetrace
