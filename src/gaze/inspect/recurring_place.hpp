// SPDX-License-Identifier: Apache-2.0
// Numbers that loggers write for a place that they do not know.
#pragma once

#include <cstddef>
#include <optional>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// A place that is left and come back to by jumps alone, over and over: no eye does that.
struct RecurringPlace {
  Vec3d raw;             // in the file's unit; z only of vectors
  std::size_t rows = 0;  // that count as good
};

// The one with most rows: beside the display one that is come to rarely, else one with a hundredth of the rows.
std::optional<RecurringPlace> find_recurring_place(const RawGaze& raw, const Conventions& conventions);

}  // namespace gazetrace
