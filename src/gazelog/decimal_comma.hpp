// SPDX-License-Identifier: Apache-2.0
// Numbers with decimal commas in tables whose columns commas separate as well: "0,0,206,8,152,4" for 0.0, 206.8, 152.4.
#pragma once

#include <vector>

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

struct DecimalCommas {
  enum class Status : std::uint8_t {
    none,       // rows hold no more cells than there are columns
    found,      // `fractions` fits all rows, and nothing else does
    ambiguous,  // more cells than columns, and no single reading of them
  };
  Status status = Status::none;
  std::vector<bool> fractions;  // for each column: its numbers stand in two cells
};

// From the first rows below a comma-separated header, or below @DATA. A cell that begins with a needless 0 ("05") or is
// longer than any whole number can only be a fraction, one with a sign or without digits can only begin a number; where
// several readings are left, the one in which the columns change the least from row to row wins if it does so clearly.
DecimalCommas find_decimal_commas(const GazeFile& file);

}  // namespace gazetrace
