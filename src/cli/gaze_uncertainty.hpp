// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze_objects.hpp"

namespace CLI {
class App;
}

namespace gazetrace {

// How far the gaze may be off, for the commands that say what it fell on. NaN unless it is given: the log is asked.
void add_uncertainty_options(CLI::App& app, GazeUncertainty& uncertainty);

}  // namespace gazetrace
