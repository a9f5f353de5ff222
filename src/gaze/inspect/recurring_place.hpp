// SPDX-License-Identifier: Apache-2.0
// Finds the numbers that loggers write in place of a position that they do not know.
#pragma once

#include <cstddef>
#include <optional>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// A place that gaze leaves and returns to by jumps alone, over and over, which no eye does.
struct RecurringPlace {
  Vec3d raw;             // in the file's unit; z only of vectors
  std::size_t rows = 0;  // the rows at this place that count as good
};

// The place with the most rows. Beside the display a few rows are enough; elsewhere it takes a hundredth of the rows.
std::optional<RecurringPlace> find_recurring_place(const RawGaze& raw, const Conventions& conventions);

}  // namespace gazetrace
