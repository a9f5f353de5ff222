// SPDX-License-Identifier: Apache-2.0
// Numbers that loggers write for a place that they do not know.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

// -32768 and sizes from 1e7 on are no coordinate in any unit.
bool is_missing_marker(double coordinate);

// Raw u, v with a marker, or with options.missing_value in both, become NaN and lost.
void mark_missing_values(GazeLog& log, const GazeReadOptions& options);

// A place at which many rows of a log lie, and one of them.
struct FrequentPlace {
  Vec3d raw;               // as in the file: a direction, or u, v, 0
  std::size_t sample = 0;  // index
};
// `samples` have directions, or u, v, as the file has them. At most a few thousand places, whatever the log's length.
std::vector<FrequentPlace> frequent_places(const std::vector<GazeSample>& samples, GazeKind kind);

// A place that gaze comes to again and again, and from elsewhere by a jump: beside the display rarely, else in a
// hundredth of the rows and at no other place alike. `frequent` was found before the same samples became fractions of
// the display or unit vectors, as `log.kind` says, which they are now.
struct Mark {
  Vec3d raw;
  std::size_t rows = 0;
};
std::optional<Mark> find_mark(const GazeLog& log, const std::vector<FrequentPlace>& frequent);

}  // namespace gazetrace
