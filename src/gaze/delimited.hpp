// SPDX-License-Identifier: Apache-2.0
// Logs in rows and columns: `#` preamble, header, cells between commas, semicolons or tabs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/columns.hpp"
#include "gaze/gaze_format.hpp"

namespace gazetrace {

struct DelimitedTable {
  char separator = ',';
  bool has_quotes = false;
  std::vector<ColumnHeading> headings;  // numbered from 1 where the file has no header
  bool has_header = false;
  std::string_view header;  // its line
  std::int64_t header_line = 0;
  std::string_view body;         // from the first row
  std::int64_t lines_above = 0;  // before the body
  // Of the preamble.
  std::optional<int> gazetrace_version;
  std::string clock;
  std::optional<DisplayGeometry> geometry;
};

// Error(input) for preamble lines that state a geometry wrongly. A file without any row has no headings.
DelimitedTable open_table(const GazeFile& file);

enum class ValidityStyle { any, names };  // names: only those of GazeValidity, 0 and 1

// Reads the rows and converts positions; everything but order, duplicates and eyes.
GazeLog read_table(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                   ValidityStyle style);

}  // namespace gazetrace
