// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

// Loggers of game engines write a vector or a quaternion into one cell, "(0.1, -0.2, 0.9)". Such cells become one for
// each component, and their headings get _x, _y, _z and _w; the lines stay where they are. Cells of two numbers stay as
// they are.
void split_vector_cells(GazeFile& file);

}  // namespace gazetrace
