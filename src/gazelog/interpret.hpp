// SPDX-License-Identifier: Apache-2.0
// From the numbers of a file to samples. This is the only place where a unit, an origin or an axis changes.
#pragma once

#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// -32768 and magnitudes from 1e7 on are not a coordinate in any unit.
bool is_missing_marker(double coordinate);

// The file's x and y of the display's top left corner for the row of that index.
Vec2d corner_of(const RawGaze& raw, const Conventions& conventions, std::size_t row);

// The rows of a log of positions (of more than two millions every n-th) with x and y in `conventions.unit`: without the
// marks of missing values, counted from the display's corner, and with the axes in their order. Guesses are made from
// these.
std::vector<RawSample> measurable_rows(const RawGaze& raw, const Conventions& conventions);

// Makes one sample of each row, in the order of the file, and adds what holds for all of them: kind, geometry, origins,
// witnesses, warnings. Rows are neither sorted nor joined. The only thing that is rejected is a unit that needs a
// display which is not known.
GazeLog interpret_rows(const RawGaze& raw, const Conventions& conventions);

Vec3d from_axes(const Vec3d& v, GazeAxes axes);

// Keeps the poses whose times increase, and makes them of unit length.
void finish_head(GazeLog& log);

}  // namespace gazetrace
