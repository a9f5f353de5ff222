// SPDX-License-Identifier: Apache-2.0
// Numbers that loggers write for a place that they do not know.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// -32768 and sizes from 1e7 on are no coordinate in any unit.
bool is_missing_marker(double coordinate);

// Raw u, v with a marker, or with options.missing_value in both, become NaN and lost.
void mark_missing_values(GazeLog& log, const GazeReadOptions& options);

// A place at which many rows of a log lie, and one of them.
struct FrequentPlace {
  double x = 0, y = 0;     // as in the file
  std::size_t sample = 0;  // index
};
// `samples` have u, v as the file has them. At most a few thousand places, whatever the log's length.
std::vector<FrequentPlace> frequent_places(const std::vector<GazeSample>& samples);

// `frequent` was found before u, v of the same samples became fractions of the display, which they are now.
std::optional<RecurringPlace> find_recurring_place(const GazeLog& log, const std::vector<FrequentPlace>& frequent);

}  // namespace gazetrace
