// SPDX-License-Identifier: Apache-2.0
// Numbers with decimal commas in tables whose columns are separated by commas as well: "0,0,206,8,152,4" for 0.0,
// 206.8, 152.4.
#pragma once

#include <vector>

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

struct DecimalCommas {
  enum class Status : std::uint8_t {
    none,       // rows have no more cells than there are columns
    found,      // `fractions` is the only reading that fits all rows
    ambiguous,  // there are more cells than columns, and no reading of them is certain
  };
  Status status = Status::none;
  std::vector<bool> fractions;  // for each column: whether its numbers stand in two cells
};

// Decided from the first rows below a comma-separated header, or below @DATA. A cell that begins with a needless 0
// ("05") or is longer than any whole number can only be a fraction. A cell with a sign or without digits can only begin
// a number. Where several readings are left, the one in which the columns change the least from row to row wins, if the
// difference is clear.
DecimalCommas find_decimal_commas(const GazeFile& file);

// Throws Error(input) where commas separate the cells and also group the digits of some numbers: rows hold more cells
// than there are columns, but only those whose numbers are large.
void refuse_thousands(const GazeFile& file);

}  // namespace gazetrace
