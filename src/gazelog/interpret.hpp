// SPDX-License-Identifier: Apache-2.0
// From the rows of a file to a log.
#pragma once

#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Makes one sample of each row, in the order of the file, and adds what holds for all of them: kind, geometry, origins,
// witnesses, warnings. Rows are neither sorted nor joined. The only thing that is rejected is a unit that needs a
// display which is not known.
GazeLog interpret_rows(const RawGaze& raw, const Conventions& conventions);

// Keeps the poses whose times increase, and makes them of unit length.
void finish_head(GazeLog& log);

}  // namespace gazetrace
