// SPDX-License-Identifier: Apache-2.0
#include "gazelog/log_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/statistics.hpp"
#include "core/text.hpp"
#include "gazelog/table.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostRows = 200;
constexpr std::size_t kMostColumns = 12;  // with more there would be too many readings to try

using Row = std::vector<std::string_view>;

struct RowsOfCells {
  std::size_t columns = 0;
  std::vector<Row> rows;
};

bool all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_whole(std::string_view text) {
  const bool sign = !text.empty() && (text.front() == '-' || text.front() == '+');
  return all_digits(text.substr(sign ? 1 : 0));
}

RowsOfCells first_rows(const GazeFile& file) {
  RowsOfCells found;
  const std::string_view head = head_of(file);
  const bool is_arff = to_lower(head.substr(0, 4096)).find("@attribute") != std::string::npos;
  bool in_rows = false;
  LineReader lines(head);
  Row cells;
  for (std::string_view line; found.rows.size() < kMostRows && lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#' || text.front() == '%') {
      continue;
    }
    if (!in_rows && is_arff) {
      const std::string lower = to_lower(text.substr(0, 10));
      found.columns += lower.starts_with("@attribute") ? 1 : 0;
      in_rows = lower.starts_with("@data");
      continue;
    }
    if (text.find_first_of("\t;\"") != std::string_view::npos) {
      return {};  // other separators, quotes
    }
    if (lines.rest().empty() && head.size() < file.text.size()) {
      break;  // the head ends within this line
    }
    split_cells(text, ',', cells);
    while (cells.size() > 1 && trim(cells.back()).empty()) {
      cells.pop_back();
    }
    if (!in_rows) {
      found.columns = cells.size();
      in_rows = true;
      continue;
    }
    for (std::string_view& cell : cells) {
      cell = trim(cell);
    }
    // Rows with missing or named values tell too little about which cells belong together.
    if (std::all_of(cells.begin(), cells.end(), is_whole)) {
      found.rows.push_back(cells);
    }
  }
  return found;
}

// The numbers of a row under a reading; empty where it does not fit.
std::optional<std::vector<double>> numbers_of(const Row& row, const std::vector<bool>& fractions) {
  std::vector<double> numbers;
  std::size_t at = 0;
  for (const bool fraction : fractions) {
    if (at + (fraction ? 1 : 0) >= row.size()) {
      return std::nullopt;
    }
    std::string text(row[at++]);
    const std::size_t digits = text.find_first_of("0123456789");
    const bool needless_zero = text.size() > digits + 1 && text[digits] == '0';
    if (needless_zero || text.size() > 18) {
      return std::nullopt;
    }
    if (fraction) {
      if (!all_digits(row[at])) {
        return std::nullopt;
      }
      text += '.';
      text += row[at++];
    }
    numbers.push_back(number_from(text).value_or(0));
  }
  return at == row.size() ? std::optional(numbers) : std::nullopt;
}

// The sum over all columns of the median step as a fraction of the column's range, plus 1 where the first column, which
// is nearly always the time, goes back. A negative value means that the reading does not fit.
double roughness(const RowsOfCells& table, const std::vector<bool>& fractions) {
  std::vector<std::vector<double>> rows;
  for (const Row& row : table.rows) {
    auto numbers = numbers_of(row, fractions);
    if (!numbers) {
      return -1;
    }
    rows.push_back(std::move(*numbers));
  }
  double sum = 0;
  for (std::size_t c = 0; c < table.columns; ++c) {
    double low = rows.front()[c];
    double high = low;
    std::vector<double> steps;
    for (std::size_t r = 1; r < rows.size(); ++r) {
      low = std::min(low, rows[r][c]);
      high = std::max(high, rows[r][c]);
      steps.push_back(std::abs(rows[r][c] - rows[r - 1][c]));
      sum += c == 0 && rows[r][c] < rows[r - 1][c] ? 1 : 0;
    }
    sum += high > low ? upper_median(steps) / (high - low) : 0;
  }
  return sum;
}

// Whether as many cells as a row has too many may be the last three digits of a number.
bool are_thousands(const Row& cells, std::size_t columns) {
  const auto is_group = [](std::string_view cell) { return cell.size() == 3 && all_digits(cell); };
  const auto groups = std::count_if(cells.begin() + 1, cells.end(), is_group);
  return static_cast<std::size_t>(groups) >= cells.size() - columns &&
         std::all_of(cells.begin(), cells.end(), is_whole);
}

}  // namespace

void refuse_thousands(const GazeFile& file) {
  constexpr std::size_t kLeastRows = 2;
  std::size_t columns = 0;
  std::size_t fitting = 0;
  std::size_t longer = 0;
  std::int64_t first_longer = 0;
  Row cells;
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#' || text.front() == '%') {
      continue;
    }
    if (columns == 0) {
      if (text.find(',') == std::string_view::npos || text.find_first_of("\t;\"{@") != std::string_view::npos) {
        return;  // other separators, quotes, or no table
      }
      split_cells(text, ',', cells);
      while (cells.size() > 1 && trim(cells.back()).empty()) {
        cells.pop_back();
      }
      columns = cells.size();
      continue;
    }
    const auto commas = static_cast<std::size_t>(std::count(text.begin(), text.end(), ','));
    if (commas + 1 <= columns || text.back() == ',') {
      ++fitting;
      continue;
    }
    split_cells(text, ',', cells);
    if (!are_thousands(cells, columns)) {
      return;
    }
    first_longer = longer++ == 0 ? lines.number() : first_longer;
  }
  if (longer >= kLeastRows && fitting > 0) {
    throw Error(ErrorKind::input, fmt::format("{}:{}", file.path, first_longer),
                fmt::format("the row holds more cells than the {} columns, as {} of {} rows do: commas separate the "
                            "columns, and group the digits of numbers from 1,000 on",
                            columns, longer, longer + fitting),
                "export again without thousands separators, or with tabs or semicolons between the columns");
  }
}

DecimalCommas find_decimal_commas(const GazeFile& file) {
  constexpr std::size_t kLeastRows = 3;
  const RowsOfCells table = first_rows(file);
  const auto longer = [&](const Row& row) { return row.size() > table.columns; };
  if (table.columns < 3 || table.rows.size() < kLeastRows ||
      !std::all_of(table.rows.begin(), table.rows.end(), longer)) {
    return {};
  }
  DecimalCommas result;
  result.status = DecimalCommas::Status::ambiguous;
  const std::size_t cells = table.rows.front().size();
  const auto as_long = [&](const Row& row) { return row.size() == cells; };
  if (table.columns > kMostColumns || cells > 2 * table.columns ||
      !std::all_of(table.rows.begin(), table.rows.end(), as_long)) {
    return result;
  }
  double best = -1;
  double second = -1;
  std::vector<bool> fractions(table.columns, false);
  std::fill(fractions.end() - static_cast<std::ptrdiff_t>(cells - table.columns), fractions.end(), true);
  do {
    const double rough = roughness(table, fractions);
    if (rough >= 0 && (best < 0 || rough < best)) {
      second = best;
      best = rough;
      result.fractions = fractions;
    } else if (rough >= 0 && (second < 0 || rough < second)) {
      second = rough;
    }
  } while (std::next_permutation(fractions.begin(), fractions.end()));
  // A reading wins clearly if it is at most half as rough as the next one.
  if (best >= 0 && (second < 0 || best < 0.5 * second)) {
    result.status = DecimalCommas::Status::found;
  }
  return result;
}

}  // namespace gazetrace
