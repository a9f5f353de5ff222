// SPDX-License-Identifier: Apache-2.0
// The columns of a Gazepoint Analysis log; what they hold stands in formats/gazepoint.cpp.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gazelog/table.hpp"

namespace gazetrace {

// The pupils of the left and the right eye, in one unit.
struct GazepointPupils {
  struct Columns {
    std::optional<std::size_t> size, valid;
  };
  std::array<Columns, 2> eyes;
  std::string unit, columns, detail;  // the last two in words; all are empty where there are no pupils

  // Of one eye; of both, the mean of those that were measured. NaN where there is none.
  [[nodiscard]] double of(TableRows& rows, Eye eye) const;
};

struct GazepointPoint {
  Eye eye = Eye::cyclopean;
  std::size_t x = 0, y = 0;
  std::optional<std::size_t> valid;
};

struct GazepointColumns {
  std::optional<std::size_t> seconds, ticks;  // TIME, TIMETICK
  std::size_t time = 0;                       // the one of the stamps
  GazepointPupils pupils;
  std::vector<GazepointPoint> points;
  std::optional<std::size_t> blink, media, aoi;
  std::optional<std::size_t> fixation, fixation_valid, fixation_start, fixation_duration;

  [[nodiscard]] bool is_by_ticks() const { return ticks && time == *ticks; }
  [[nodiscard]] bool state_fixations() const { return fixation && fixation_start && fixation_duration && seconds; }
};

// Error(input) where the log has no stamps or no points of gaze.
GazepointColumns find_gazepoint_columns(const DelimitedTable& table, const GazeReadOptions& options,
                                        const std::string& place);
std::size_t needed_cells(const GazepointColumns& columns);

}  // namespace gazetrace
