// SPDX-License-Identifier: Apache-2.0
// Numbers that loggers write for a place that they do not know.
#pragma once

#include <vector>

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// -32768 and sizes from 1e7 on are no coordinate in any unit.
bool is_missing_marker(double coordinate);

// Raw u, v with a marker, or with options.missing_value in both, become NaN and lost.
void mark_missing_values(GazeLog& log, const GazeReadOptions& options);

// `raw`: u, v of each sample as the file has them; `log.samples` has them as fractions of the display.
std::optional<RecurringPlace> find_recurring_place(const GazeLog& log, const std::vector<Vec2d>& raw);

}  // namespace gazetrace
