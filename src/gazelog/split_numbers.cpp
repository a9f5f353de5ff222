// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "core/text.hpp"
#include "gazelog/log_file.hpp"
#include "gazelog/table.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

void refuse_split_numbers(const GazeFile& file) {
  constexpr std::size_t kLeastRows = 2;
  const bool is_arff = to_lower(head_of(file, 4096)).find("@attribute") != std::string::npos;
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t longer = 0;
  std::int64_t first_longer = 0;
  bool in_rows = false;
  std::vector<std::string_view> cells;
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#' || text.front() == '%') {
      continue;
    }
    if (!in_rows && is_arff) {
      const std::string word = to_lower(text.substr(0, 10));
      columns += word == "@attribute" ? 1 : 0;
      in_rows = word.starts_with("@data");
      continue;
    }
    if (!in_rows &&
        (text.find(',') == std::string_view::npos || text.find_first_of("\t;\"{") != std::string_view::npos)) {
      return;  // other separators, quotes, or no table
    }
    const auto commas = static_cast<std::size_t>(std::count(text.begin(), text.end(), ','));
    if (!in_rows) {
      columns = commas + (text.back() == ',' ? 0 : 1);
      in_rows = true;
      continue;
    }
    ++rows;
    if (commas < columns || text.back() == ',') {
      continue;
    }
    split_cells(text, ',', cells);
    const auto behind_a_comma = std::count_if(cells.begin() + 1, cells.end(), [](std::string_view cell) {
      return !cell.empty() && cell.find_first_not_of("0123456789") == std::string_view::npos;
    });
    if (static_cast<std::size_t>(behind_a_comma) < cells.size() - columns) {
      return;
    }
    first_longer = longer++ == 0 ? lines.number() : first_longer;
  }
  if (longer >= kLeastRows) {
    throw Error(ErrorKind::input, place_of(file, first_longer),
                fmt::format("the row holds more cells than the {} columns, as {} of {} rows do: commas separate the "
                            "columns, and stand in numbers as well, as decimal marks or between thousands",
                            columns, longer, rows),
                "export again with decimal points and without thousands separators, or with tabs or semicolons "
                "between the columns");
  }
}

}  // namespace gazetrace
