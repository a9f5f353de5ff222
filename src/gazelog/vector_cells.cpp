// SPDX-License-Identifier: Apache-2.0
#include "gazelog/log_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/text.hpp"
#include "gazelog/table.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kLeastComponents = 2, kMostComponents = 4;

// The components of a cell such as (1, 2, 3), [1;2;3], (1 2 3) or Unreal's X=1 Y=2 Z=3; none for any other.
std::vector<std::string_view> components_of(std::string_view cell) {
  std::vector<std::string_view> parts;
  std::string_view text = trim(cell);
  if (text.size() > 1 && text.front() == '"' && text.back() == '"') {
    text = trim(text.substr(1, text.size() - 2));
  }
  const bool is_in_brackets =
      text.size() > 2 && ((text.front() == '(' && text.back() == ')') || (text.front() == '[' && text.back() == ']'));
  const bool is_named = text.starts_with("X=");
  if (!is_in_brackets && !is_named) {
    return parts;
  }
  text = is_named ? text : text.substr(1, text.size() - 2);
  const char mark = text.find(',') != std::string_view::npos   ? ','
                    : text.find(';') != std::string_view::npos ? ';'
                                                               : ' ';
  split_cells(text, mark, parts);
  for (std::string_view& part : parts) {
    part = trim(part);
    if (is_named && part.size() > 1 && part[1] == '=' &&
        part[0] == "XYZW"[std::min<std::size_t>(3, &part - parts.data())]) {
      part.remove_prefix(2);
    }
    if (!number_from(part) && !is_missing(part)) {
      return {};
    }
  }
  return parts;
}

// As split_cells, but brackets hold a cell together as quotes do.
void split_outside_brackets(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  std::size_t begin = 0;
  int depth = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    is_quoted = c == '"' ? !is_quoted : is_quoted;
    depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
    if (c == separator && depth <= 0 && !is_quoted) {
      cells.push_back(line.substr(begin, i - begin));
      begin = i + 1;
      depth = 0;
    }
  }
  cells.push_back(line.substr(begin));
}

}  // namespace

void split_vector_cells(GazeFile& file) {
  const std::string_view head = head_of(file, 16384);
  if ((head.find_first_of("([") == std::string_view::npos && head.find("X=") == std::string_view::npos) ||
      head.find('\0') != std::string_view::npos) {
    return;
  }
  const GazeFile start{file.path, std::string(head)};
  const DelimitedTable table = open_table(start);
  if (!table.has_header || table.body.empty()) {
    return;
  }
  std::vector<std::string_view> cells;
  split_outside_brackets(table.body.substr(0, table.body.find('\n')), table.separator, cells);
  std::vector<std::size_t> components(cells.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t count = components_of(cells[i]).size();
    constexpr std::size_t kList = 12;
    const std::string_view cell = trim(cells[i]);
    const bool has_objects = cell.starts_with("[{") || cell.starts_with("\"[{");
    if (has_objects || (count > kList && i + 1 < cells.size() && components_of(cells[i + 1]).size() == count)) {
      throw Error(ErrorKind::input, place_of(file, table.lines_above + 1),
                  fmt::format("a cell of this row holds a list of {}, as PsychoPy and jsPsych write a trial",
                              has_objects ? "samples" : fmt::format("{} numbers", count)),
                  "write a row for each sample, such as with pandas: explode()");
    }
    components[i] = count >= kLeastComponents && count <= kMostComponents ? count : 0;
    any = any || components[i] > 0;
  }
  if (!any) {
    return;
  }
  static constexpr std::array<std::string_view, kMostComponents> kNames{"_x", "_y", "_z", "_w"};
  std::string text;
  text.reserve(file.text.size());
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const bool is_header = lines.number() == table.header_line;
    if (lines.number() < table.header_line) {
      text.append(line) += '\n';
      continue;
    }
    if (is_header) {
      split_cells(line, table.separator, cells);
    } else {
      split_outside_brackets(line, table.separator, cells);
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text += i == 0 ? "" : std::string(1, table.separator);
      const std::size_t count = i < components.size() ? components[i] : 0;
      if (count == 0) {
        text += cells[i];
        continue;
      }
      const std::vector<std::string_view> parts = is_header ? std::vector<std::string_view>() : components_of(cells[i]);
      std::string buffer;
      const std::string name(cell_text(cells[i], buffer));
      for (std::size_t k = 0; k < count; ++k) {
        text += k == 0 ? "" : std::string(1, table.separator);
        text += is_header ? name + std::string(kNames[k]) : k < parts.size() ? std::string(parts[k]) : "";
      }
    }
    text += '\n';
  }
  file.text = std::move(text);
}

}  // namespace gazetrace
