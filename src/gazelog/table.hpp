// SPDX-License-Identifier: Apache-2.0
// Logs in rows and columns: a preamble of `#` lines, a header, and cells between commas, semicolons or tabs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/nan.hpp"
#include "gazelog/gaze_format.hpp"

namespace gazetrace {

// "gaze x [px]", "time (ms)", "x_px": name and unit; the text of the cell is kept for messages.
struct ColumnHeading {
  std::string text, name, unit;
};
ColumnHeading parse_heading(std::string_view cell);
std::string letters_and_digits(std::string_view text);  // in lower case, ASCII only, without anything else

// Empty cells, ".", "n/a", "NaN", "-nan(ind)", "None", ...
bool is_missing(std::string_view text);

using OptionalColumn = std::optional<std::size_t>;
using VectorColumns = std::array<OptionalColumn, 3>;  // of x, y and z

// The separator of a line of cells: a tab or else a semicolon, where it has one, or else `otherwise`.
char separator_of(std::string_view line, char otherwise);

struct PreambleLine {
  std::string_view text;
  std::int64_t line = 0;
};

struct DelimitedTable {
  char separator = ',';
  bool has_quotes = false;
  std::vector<ColumnHeading> headings;  // numbered from 1 where the file has no header
  bool has_header = false;
  std::string_view header;  // its line
  std::int64_t header_line = 0;
  std::string_view body;         // from the first row
  std::int64_t lines_above = 0;  // before the body
  std::vector<PreambleLine> preamble;
  std::string place;  // file:line of the header

  // Finds a column by its whole text or its name, ignoring blanks, punctuation and case. Throws Error(input) where two
  // columns have that name.
  [[nodiscard]] OptionalColumn find(std::string_view name) const;
  [[nodiscard]] OptionalColumn find_any(std::initializer_list<std::string_view> names) const;
  [[nodiscard]] bool has_all(std::initializer_list<std::string_view> names) const;
  // Throws Error(input) naming both columns where another column has exactly the name of `column`.
  void check_unique(std::size_t column) const;
};

// A file without any row has no headings.
DelimitedTable open_table(const GazeFile& file);
// A table without a header: all of the text is rows.
DelimitedTable open_headerless(std::string_view text, char separator, const std::vector<std::string>& names);

// A column that the user names: by its whole text, by its name without the unit, or by its number from 1. Error(input).
std::size_t declared_column(const DelimitedTable& table, const std::string& name);
std::string column_listing(const DelimitedTable& table);

// The columns that a reader takes from a table, and how many cells a row must have to hold them.
class UsedColumns {
 public:
  explicit UsedColumns(const DelimitedTable& table) : table_(table) {}

  OptionalColumn use(OptionalColumn column) {
    needed_ = std::max(needed_, column ? *column + 1 : 0);
    return column;
  }
  OptionalColumn find(std::string_view name) { return use(table_.find(name)); }
  // Throws Error(input) where there is none; without a `remedy` it lists the columns that there are.
  std::size_t require(std::string_view name, std::string_view remedy = {});
  // The column of the stamps: the one that the user named or, without one, the format's own.
  std::size_t time(const GazeReadOptions& options, std::size_t own);
  [[nodiscard]] std::size_t needed() const { return needed_; }

 private:
  const DelimitedTable& table_;
  std::size_t needed_ = 0;
};

// From written stamps to nanoseconds: (stamp - subtract) * 10^exponent, in integers.
struct TimeScale {
  int exponent = 0;
  std::int64_t subtract = 0;  // in the unit of the stamps, which are whole numbers then
};

// Refuses a row of which a cell holds bytes of value zero, as after a crash: what is wrong with it otherwise follows
// from them.
void refuse_zero_bytes(const std::vector<std::string_view>& cells, const std::string& place);

// Goes through the rows. Blank lines, comments and repetitions of the header are skipped.
class TableRows {
 public:
  // Rows must have `needed` cells; the text behind these is not split.
  TableRows(const GazeFile& file, const DelimitedTable& table, std::size_t needed);

  bool next();
  [[nodiscard]] std::int64_t line() const { return line_; }
  [[nodiscard]] bool is_short() const { return cells_.size() < needed_; }
  // Throws Error(input) for a row that is_short().
  void check_length() const;
  // Trimmed, without quotes; empty where the row is too short. Valid until the next call.
  std::string_view cell(std::size_t column);
  std::string_view cell(const OptionalColumn& column) { return column ? cell(*column) : ""; }
  // NaN where the value is missing. Throws Error(input) for text that is not a number.
  double number(std::size_t column);
  double number(const OptionalColumn& column) { return column ? number(*column) : kNan; }
  Vec3d vector(const VectorColumns& columns) { return {number(columns[0]), number(columns[1]), number(columns[2])}; }
  std::int64_t time_ns(std::size_t column, const TimeScale& scale);
  [[noreturn]] void fail(const std::string& problem, std::string_view remedy) const;

  std::size_t repeated_headers = 0;

 private:
  // Numbers with a comma or a point, of one column: such as could have it between thousands and hundreds, and others.
  struct GroupMarks {
    bool has_others = false;
    std::size_t grouped = 0;
    std::int64_t first_line = 0;
    std::string first;
  };
  // The next row, without a look at what the columns hold.
  bool read();
  [[nodiscard]] std::string thousands_problem(std::string_view text, std::size_t column) const;
  void note_group_mark(std::size_t column, std::string_view text);
  // Throws Error(input) where the numbers of a column that are below a thousand are the only ones without such a mark.
  void refuse_thousands() const;

  const GazeFile& file_;
  const DelimitedTable& table_;
  std::size_t needed_;
  std::string_view rest_;
  std::int64_t line_;
  std::vector<std::string_view> cells_;
  std::string buffer_;
  std::vector<GroupMarks> group_marks_;  // by column
};

std::string place_of(const GazeFile& file, std::int64_t line);

}  // namespace gazetrace
