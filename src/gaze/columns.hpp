// SPDX-License-Identifier: Apache-2.0
// Which column of a table holds what, from its header text and from what the user declares.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze.hpp"

namespace gazetrace {

// "gaze x [px]", "time (ms)", "x_px": name and unit; the text of the cell is kept for messages.
struct ColumnHeading {
  std::string text, name, unit;
};
ColumnHeading parse_heading(std::string_view cell);

struct ColumnPlan {
  std::size_t time = 0, x = 0, y = 0;
  std::optional<std::size_t> z, validity, confidence, pupil, eye;
  GazeKind kind = GazeKind::screen;
  std::optional<int> time_exponent;  // empty: by statistics
  PositionUnit unit = PositionUnit::automatic;
  PositionOrigin origin = PositionOrigin::automatic;
  Warnings warnings;
};

// `place` is file:line of the header. Error(input) for columns that are not there and units that are unknown.
ColumnPlan plan_columns(const std::vector<ColumnHeading>& headings, const GazeColumns& declared,
                        const std::string& place);

}  // namespace gazetrace
