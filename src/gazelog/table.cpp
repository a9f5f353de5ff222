// SPDX-License-Identifier: Apache-2.0
#include "gazelog/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "core/text.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

bool is_number_row(const std::vector<std::string_view>& cells) {
  std::string buffer;
  bool any = false;
  for (const std::string_view cell : cells) {
    const std::string_view text = cell_text(cell, buffer);
    const bool number = number_from(text).has_value();
    if (!number && !is_missing(text)) {
      return false;
    }
    any = any || number;
  }
  return any;
}

// Only the first `count` cells are needed; outside of quotes a cell ends at the next separator.
void split_row(std::string_view line, const DelimitedTable& table, std::size_t count,
               std::vector<std::string_view>& cells) {
  if (table.has_quotes) {
    split_cells(line, table.separator, cells);
    return;
  }
  cells.clear();
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto next_separator = [&](const char* from) {
    const auto* const found = static_cast<const char*>(
        from == end ? nullptr : std::memchr(from, table.separator, static_cast<std::size_t>(end - from)));
    return found == nullptr ? end : found;
  };
  while (cells.size() < count) {
    const char* const stop = next_separator(at);
    cells.emplace_back(at, static_cast<std::size_t>(stop - at));
    if (stop == end) {
      return;
    }
    at = stop + 1;
  }
}

bool is_row(std::string_view line) {
  const std::string_view text = trim(line);
  return !text.empty() && text.front() != '#';
}

// By its whole text or its name, of which `normal` makes what is compared.
template <class Normal>
OptionalColumn first_called(const std::vector<ColumnHeading>& headings, const std::string& wanted,
                            const Normal& normal) {
  for (const auto part : {&ColumnHeading::text, &ColumnHeading::name}) {
    for (std::size_t i = 0; i < headings.size(); ++i) {
      if (normal(headings[i].*part) == wanted) {
        return i;
      }
    }
  }
  return std::nullopt;
}

OptionalColumn first_called(const std::vector<ColumnHeading>& headings, std::string_view name) {
  return first_called(headings, letters_and_digits(name), letters_and_digits);
}

std::vector<std::string> texts_of(const DelimitedTable& table) {
  std::vector<std::string> texts;
  for (const ColumnHeading& heading : table.headings) {
    texts.push_back(heading.text);
  }
  return texts;
}

constexpr std::string_view kThousandsRemedy =
    "export again without thousands separators, or remove them from the numbers of that column";

// Whether `mark` stands before every three digits of the whole part, as in 1,234 and -12,345,678.9; the fraction begins
// with a point, or with a comma where the mark is a point.
bool is_grouped_by(std::string_view text, char mark) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    text.remove_prefix(1);
  }
  text = text.substr(0, text.find(mark == '.' ? ',' : '.'));
  const std::size_t first = text.find(mark);
  if (first == std::string_view::npos || first == 0 || first > 3 || text.front() == '0') {
    return false;
  }
  const auto are_digits = [](std::string_view part) {
    return part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  for (std::size_t at = first; at < text.size(); at += 4) {
    if (text[at] != mark || text.size() - at < 4 || !are_digits(text.substr(at + 1, 3))) {
      return false;
    }
  }
  return are_digits(text.substr(0, first));
}

// For a text that is no number: whether it is one with thousands separators of any country, 1,234.5 as well as 1.234,5
// and those with apostrophes or blanks, of which spreadsheets write several.
bool has_thousands(std::string_view text) {
  std::string plain(text);
  for (const std::string_view mark : {"'", " ", "\u00a0", "\u2009", "\u2019", "\u202f"}) {
    for (std::size_t at = plain.find(mark); at != std::string::npos; at = plain.find(mark, at)) {
      plain.replace(at, mark.size(), "_");
    }
  }
  std::string with_point = plain;
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  return is_grouped_by(plain, ',') || is_grouped_by(plain, '.') || is_grouped_by(with_point, '_');
}

// 12:30, 12:30:05.250 and 2026-05-01T12:30:05Z.
bool is_time_of_day(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto is_digit = [&](std::size_t at) { return at < text.size() && text[at] >= '0' && text[at] <= '9'; };
  return colon != std::string_view::npos && colon > 0 && is_digit(colon - 1) && is_digit(colon + 1) &&
         is_digit(colon + 2);
}

bool is_known_unit(std::string_view text) {
  return time_exponent(text).has_value() || position_unit_from(text).has_value();
}

}  // namespace

char separator_of(std::string_view line, char otherwise) {
  return line.find('\t') != std::string_view::npos ? '\t' : line.find(';') != std::string_view::npos ? ';' : otherwise;
}

std::string letters_and_digits(std::string_view text) {
  std::string kept;
  for (const char c : to_lower(text)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      kept += c;
    }
  }
  return kept;
}

ColumnHeading parse_heading(std::string_view cell) {
  std::string buffer;
  const std::string_view text = cell_text(cell, buffer);
  ColumnHeading heading{std::string(text), std::string(text), ""};
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t at = text.rfind(open);
    if (at != std::string_view::npos && at > 0 && text.back() == close) {
      heading.name = trim(text.substr(0, at));
      heading.unit = trim(text.substr(at + 1, text.size() - at - 2));
      return heading;
    }
  }
  // "x_px", "time_ms": only where the last part is a unit and not a column itself; else "yaw_rads_cpf", "gaze_deg_x".
  const std::size_t bar = text.rfind('_');
  if (bar == std::string_view::npos || bar == 0) {
    return heading;
  }
  const std::size_t before = text.rfind('_', bar - 1);
  const std::string_view last = text.substr(bar + 1);
  if (is_known_unit(last) && last != "1") {
    heading.name = text.substr(0, bar);
    heading.unit = last;
  } else if (before != std::string_view::npos && before > 0 && bar - before > 2 &&
             is_known_unit(text.substr(before + 1, bar - before - 1))) {
    heading.name = text.substr(0, before);
    heading.name += last == "cpf" ? "" : text.substr(bar);  // a frame of the head, not a part of the name
    heading.unit = text.substr(before + 1, bar - before - 1);
  }
  return heading;
}

bool is_missing(std::string_view text) {
  if (text.empty() || text == "." || text == "-") {
    return true;
  }
  if (text.size() > 9) {
    return false;
  }
  const std::string lower = to_lower(text);
  for (const std::string_view marker : {"n/a", "na", "nan", "-nan", "-nan(ind)", "nan(ind)", "none", "null"}) {
    if (lower == marker) {
      return true;
    }
  }
  return false;
}

std::string place_of(const GazeFile& file, std::int64_t line) {
  return fmt::format("{}:{}", file.path, line);
}

void DelimitedTable::check_unique(std::size_t column) const {
  const std::string wanted = letters_and_digits(headings[column].text);
  for (std::size_t i = 0; i < headings.size(); ++i) {
    if (i != column && !wanted.empty() && letters_and_digits(headings[i].text) == wanted) {
      throw Error(
          ErrorKind::input, place,
          fmt::format("columns {} ('{}') and {} ('{}') have one name", std::min(column, i) + 1,
                      headings[std::min(column, i)].text, std::max(column, i) + 1, headings[std::max(column, i)].text),
          "rename the one that is not meant, or name columns by number, such as `x-column` 2");
    }
  }
}

OptionalColumn DelimitedTable::find(std::string_view name) const {
  const auto found = first_called(headings, name);
  if (found) {
    check_unique(*found);
  }
  return found;
}

OptionalColumn DelimitedTable::find_any(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    if (const auto found = find(name)) {
      return found;
    }
  }
  return std::nullopt;
}

bool DelimitedTable::has_all(std::initializer_list<std::string_view> names) const {
  return std::all_of(names.begin(), names.end(),
                     [&](std::string_view name) { return first_called(headings, name).has_value(); });
}

DelimitedTable open_table(const GazeFile& file) {
  constexpr std::size_t kMostColumns = 16384;
  DelimitedTable table;
  table.place = place_of(file, 0);
  table.has_quotes = file.text.find('"') != std::string::npos;
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty()) {
      continue;
    }
    if (text.front() == '#') {
      table.preamble.push_back({text, lines.number()});
      continue;
    }
    table.separator = separator_of(line, ',');
    std::vector<std::string_view> cells;
    split_cells(line, table.separator, cells);
    table.has_header = !is_number_row(cells);
    table.header = line;
    table.header_line = lines.number();
    if (cells.size() > kMostColumns) {
      throw Error(ErrorKind::input, place_of(file, lines.number()), fmt::format("has {} columns", cells.size()),
                  fmt::format("no tracker or spreadsheet writes more than {}: is this a gaze log?", kMostColumns));
    }
    while (cells.size() > 1 && trim(cells.back()).empty()) {
      cells.pop_back();  // trailing separators
    }
    for (const std::string_view cell : cells) {
      table.headings.push_back(table.has_header ? parse_heading(cell) : ColumnHeading{});
      if (!table.has_header) {
        table.headings.back().text = table.headings.back().name = std::to_string(table.headings.size());
      }
    }
    const char* const body = table.has_header ? lines.rest().data() : line.data();
    table.body = std::string_view(body, static_cast<std::size_t>(file.text.data() + file.text.size() - body));
    table.lines_above = table.has_header ? lines.number() : lines.number() - 1;
    table.place = place_of(file, table.header_line);
    break;
  }
  return table;
}

DelimitedTable open_headerless(std::string_view text, char separator, const std::vector<std::string>& names) {
  DelimitedTable table;
  table.separator = separator;
  table.body = text;
  for (const std::string& name : names) {
    table.headings.push_back({name, name, ""});
  }
  return table;
}

std::size_t declared_column(const DelimitedTable& table, const std::string& name) {
  const std::string wanted = to_lower(trim(name));
  if (const OptionalColumn found = first_called(table.headings, wanted, to_lower)) {
    table.check_unique(*found);
    return *found;
  }
  if (const std::size_t number = count_from(wanted).value_or(0); number >= 1 && number <= table.headings.size()) {
    return number - 1;
  }
  throw Error(ErrorKind::input, table.place, unknown_name_message("column", name, texts_of(table)));
}

std::string column_listing(const DelimitedTable& table) {
  return fmt::format("{}", fmt::join(texts_of(table), ", "));
}

std::size_t UsedColumns::require(std::string_view name, std::string_view remedy) {
  const OptionalColumn found = find(name);
  if (!found) {
    throw Error(ErrorKind::input, table_.place, fmt::format("there is no column '{}'", name),
                remedy.empty() ? "the columns are: " + column_listing(table_) : std::string(remedy));
  }
  return *found;
}

std::size_t UsedColumns::time(const GazeReadOptions& options, std::size_t own) {
  return *use(options.columns.time.empty() ? own : declared_column(table_, options.columns.time));
}

TableRows::TableRows(const GazeFile& file, const DelimitedTable& table, std::size_t needed)
    : file_(file), table_(table), needed_(needed), rest_(table.body), line_(table.lines_above) {}

bool TableRows::next() {
  const bool is_there = read();
  if (!is_there && !group_marks_.empty()) {
    refuse_thousands();
  }
  return is_there;
}

bool TableRows::read() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_;
    if (!line.empty() && line.back() == '\r') {
      line.remove_suffix(1);
    }
    if (!is_row(line)) {
      continue;
    }
    if (table_.has_header && line == table_.header) {
      ++repeated_headers;
      continue;
    }
    split_row(line, table_, needed_, cells_);
    return true;
  }
  return false;
}

void TableRows::note_group_mark(std::size_t column, std::string_view text) {
  if (column < group_marks_.size() && group_marks_[column].has_others) {
    return;  // the column has fractions
  }
  const std::size_t at = text.find_first_of(",.");
  if (at == std::string_view::npos) {
    return;
  }
  if (column >= group_marks_.size()) {
    group_marks_.resize(column + 1);
  }
  GroupMarks& marks = group_marks_[column];
  if (!is_grouped_by(text, text[at])) {
    marks.has_others = true;
  } else if (marks.grouped++ == 0) {
    marks.first = text;
    marks.first_line = line_;
  }
}

void TableRows::refuse_thousands() const {
  constexpr std::size_t kLeast = 2;
  // Points are the usual mark of fractions, and marks of missing values are whole numbers, too: more must be seen.
  constexpr std::size_t kLeastBelow = 1;
  constexpr std::size_t kLeastBelowWithPoints = 5;
  for (std::size_t column = 0; column < group_marks_.size(); ++column) {
    const GroupMarks& marks = group_marks_[column];
    if (marks.grouped < kLeast || marks.has_others) {
      continue;
    }
    // Of a column of decimal fractions with three digits, one or another number would be whole, or above a thousand.
    const bool are_points = marks.first.find(',') == std::string::npos;
    const std::size_t least_below = are_points ? kLeastBelowWithPoints : kLeastBelow;
    std::set<double> below;
    std::size_t above = 0;
    TableRows again(file_, table_, needed_);
    while (again.read() && above == 0) {
      const std::string_view text = again.cell(column);
      const auto value = text.find_first_of(",.") == std::string_view::npos ? number_from(text) : std::nullopt;
      above += value && std::abs(*value) >= 1000 ? 1 : 0;
      if (value && below.size() < least_below) {
        below.insert(*value);
      }
    }
    if (below.size() >= least_below && above == 0) {
      throw Error(ErrorKind::input, place_of(file_, marks.first_line), thousands_problem(marks.first, column),
                  kThousandsRemedy);
    }
  }
}

std::string TableRows::thousands_problem(std::string_view text, std::size_t column) const {
  return fmt::format("'{}' in column '{}' has thousands separators", text.substr(0, 60), table_.headings[column].text);
}

void TableRows::check_length() const {
  if (is_short()) {
    fail(fmt::format("the row has {} of the {} cells that reach to column '{}'", cells_.size(), needed_,
                     table_.headings[std::min(needed_, table_.headings.size()) - 1].text),
         "it is short or cut off; remove or mend it");
  }
}

std::string_view TableRows::cell(std::size_t column) {
  return column < cells_.size() ? cell_text(cells_[column], buffer_) : std::string_view();
}

double TableRows::number(std::size_t column) {
  const std::string_view text = cell(column);
  if (const auto value = number_from(text)) {
    note_group_mark(column, text);
    return *value;
  }
  if (has_thousands(text)) {
    fail(thousands_problem(text, column), kThousandsRemedy);
  }
  if (!is_missing(text)) {
    const std::string lower = to_lower(text);
    if (lower != "inf" && lower != "-inf") {
      fail(fmt::format("'{}' in column '{}' is not a number", text.substr(0, 60), table_.headings[column].text),
           "write missing values as an empty cell or n/a");
    }
  }
  return kNan;
}

std::int64_t TableRows::time_ns(std::size_t column, const TimeScale& scale) {
  const std::string_view text = cell(column);
  std::int64_t t_ns = 0;
  NumberStatus status = NumberStatus::ok;
  if (scale.subtract == 0) {
    status = scaled_integer(text, scale.exponent, t_ns);
  } else {
    std::int64_t factor = 1;
    for (int i = 0; i < scale.exponent; ++i) {
      factor *= 10;
    }
    status = scaled_integer(text, 0, t_ns);
    if (status == NumberStatus::ok &&
        (__builtin_sub_overflow(t_ns, scale.subtract, &t_ns) || __builtin_mul_overflow(t_ns, factor, &t_ns))) {
      status = NumberStatus::overflow;
    }
  }
  if (status == NumberStatus::ok) {
    note_group_mark(column, text);
    return t_ns;
  }
  if (has_thousands(text)) {
    fail(thousands_problem(text, column), kThousandsRemedy);
  }
  if (status == NumberStatus::overflow) {
    fail(fmt::format("time '{}' in {} does not fit int64 nanoseconds", text.substr(0, 60),
                     time_unit_text(scale.exponent)),
         "check the unit of the time column");
  }
  if (is_missing(text)) {
    fail("this row has no time", "remove the row, or give it a time");
  }
  if (is_time_of_day(text)) {
    fail(fmt::format("time '{}' is a time of day", text.substr(0, 60)),
         "write times as numbers, such as milliseconds from the beginning, or name the column of the tracker's own "
         "clock with `time-column`");
  }
  fail(fmt::format("time '{}' is not a number", text.substr(0, 60)), "remove or mend the row");
}

void refuse_zero_bytes(const std::vector<std::string_view>& cells, const std::string& place) {
  const auto has_zeros = [](std::string_view cell) { return cell.find('\0') != std::string_view::npos; };
  if (std::any_of(cells.begin(), cells.end(), has_zeros)) {
    throw Error(ErrorKind::input, place, "bytes of value zero stand in this row, as after a crash or on a full disk",
                "copy the file again, or remove the row");
  }
}

void TableRows::fail(const std::string& problem, std::string_view remedy) const {
  refuse_zero_bytes(cells_, place_of(file_, line_));
  throw Error(ErrorKind::input, place_of(file_, line_), problem, remedy);
}

}  // namespace gazetrace
