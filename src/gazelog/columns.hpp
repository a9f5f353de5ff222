// SPDX-License-Identifier: Apache-2.0
// Which column of a table holds what, from its header text and from what the user or a preset declares.
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

// The columns of one gaze: of an eye, or of both together.
struct GazeSource {
  Eye eye = Eye::cyclopean;  // unless the table has a column of it
  std::size_t x = 0, y = 0;
  OptionalColumn z, validity, confidence, pupil, openness;
  std::array<OptionalColumn, 3> origin;
};

struct ColumnPlan {
  std::size_t time = 0;
  std::vector<GazeSource> sources;  // at least one
  OptionalColumn eye, frame;
  std::array<OptionalColumn, 3> head_position;
  std::array<OptionalColumn, 4> head_rotation;  // without the last: Euler angles
  GazeKind kind = GazeKind::screen;
  std::optional<int> time_exponent;  // empty: by statistics
  PositionUnit unit = PositionUnit::automatic;
  Evidence unit_evidence = Evidence::header;
  std::string pupil_unit;
  Warnings warnings;

  [[nodiscard]] std::size_t needed_cells() const;
};

// `place` is file:line of the header. Error(input) for columns that are not there and units that are unknown.
ColumnPlan plan_columns(const DelimitedTable& table, const GazeColumns& declared, const std::string& place);

}  // namespace gazetrace
