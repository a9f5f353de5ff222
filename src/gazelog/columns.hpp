// SPDX-License-Identifier: Apache-2.0
// Decides what each column of a table holds, from its header and from what the user or a preset declares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazelog/table.hpp"

namespace gazetrace {

using OptionalColumn = std::optional<std::size_t>;

// The columns of one gaze, which is that of one eye or of both together.
struct GazeSource {
  Eye eye = Eye::cyclopean;  // unless the table has a column for it
  std::size_t x = 0, y = 0;
  OptionalColumn z, validity, confidence, pupil, openness;
  std::array<OptionalColumn, 3> origin;
};

struct ColumnPlan {
  std::size_t time = 0;
  std::vector<GazeSource> sources;  // at least one
  OptionalColumn eye, frame;
  std::array<OptionalColumn, 3> head_position;
  std::array<OptionalColumn, 4> head_rotation;  // Euler angles where the last is missing
  GazeKind kind = GazeKind::screen;
  bool x_grows_left = false;
  std::optional<int> time_exponent;  // empty: it is to be found by statistics
  PositionUnit unit = PositionUnit::automatic;
  Evidence unit_evidence = Evidence::header;
  std::string pupil_unit;
  Warnings warnings;

  [[nodiscard]] std::size_t needed_cells() const;
};

// `place` is file:line of the header. Throws Error(input) for columns that do not exist and for unknown units.
ColumnPlan plan_columns(const DelimitedTable& table, const GazeColumns& declared, const std::string& place);

}  // namespace gazetrace
