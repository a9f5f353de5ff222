// SPDX-License-Identifier: Apache-2.0
// gazetrace camera CSV: a header that names columns and units, `t[s],x[m],y[m],z[m],qx,qy,qz,qw`, after any number of
// `#` comments. The columns may come in any order, and there may be others.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kForm = "the header is `t[s],x[m],y[m],z[m],qx,qy,qz,qw`, t also in [ms], [us] or [ns]";
constexpr std::array<std::string_view, 8> kNames{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};

struct Heading {
  std::string name, unit;
};

Heading parse_heading(std::string_view cell) {
  std::string buffer;
  const std::string_view text = cell_text(cell, buffer);
  const std::size_t open = text.find('[');
  if (open == std::string_view::npos || text.back() != ']') {
    return {to_lower(text), ""};
  }
  return {to_lower(trim(text.substr(0, open))), std::string(trim(text.substr(open + 1, text.size() - open - 2)))};
}

struct Layout {
  char separator = ',';
  std::array<std::size_t, 8> columns{};
  int time_exponent = 9;
  double metres_per_unit = 1.0;
};

char separator_of(std::string_view header) {
  return header.find('\t') != std::string_view::npos ? '\t' : header.find(';') != std::string_view::npos ? ';' : ',';
}

Layout parse_header(std::string_view line, const std::string& place) {
  Layout layout;
  layout.separator = separator_of(line);
  std::vector<std::string_view> cells;
  split_cells(line, layout.separator, cells);
  std::vector<Heading> headings;
  std::vector<std::string> names;
  for (const std::string_view cell : cells) {
    headings.push_back(parse_heading(cell));
    names.push_back(headings.back().name);
  }
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), kNames[i]);
    if (found == names.end()) {
      throw Error(ErrorKind::input, place,
                  fmt::format("has no column '{}'; its columns are: {}", kNames[i], fmt::join(names, ", ")), kForm);
    }
    layout.columns[i] = static_cast<std::size_t>(found - names.begin());
    const std::string& unit = headings[layout.columns[i]].unit;
    if (i == 0) {
      const auto exponent = time_exponent(unit);
      if (!exponent) {
        throw Error(ErrorKind::input, place,
                    unit.empty() ? "the time column 't' does not state its unit"
                                 : fmt::format("unknown unit '{}' of the time column 't'", unit),
                    kForm);
      }
      layout.time_exponent = *exponent;
    } else if (i < 4) {
      const double scale = unit.empty() || unit == "m" ? 1.0 : unit == "cm" ? 0.01 : unit == "mm" ? 0.001 : 0.0;
      if (scale == 0.0 || (i > 1 && scale != layout.metres_per_unit)) {
        throw Error(ErrorKind::input, place, fmt::format("unknown or mixed unit '{}' of column '{}'", unit, kNames[i]),
                    "positions are in [m], [cm] or [mm], all three alike");
      }
      layout.metres_per_unit = scale;
    }
  }
  return layout;
}

CameraKey parse_row(const std::vector<std::string_view>& cells, const Layout& layout, const std::string& place) {
  const std::size_t needed = *std::max_element(layout.columns.begin(), layout.columns.end()) + 1;
  if (cells.size() < needed) {
    throw Error(ErrorKind::input, place, fmt::format("{} cells where the header has {}", cells.size(), needed),
                "the file may be cut off; remove or mend the line");
  }
  std::string buffer;
  CameraKey key;
  const std::string_view time = cell_text(cells[layout.columns[0]], buffer);
  const NumberStatus status = scaled_integer(time, layout.time_exponent, key.t_ns);
  if (status != NumberStatus::ok) {
    throw Error(ErrorKind::input, place,
                fmt::format("time '{}' {}", time,
                            status == NumberStatus::overflow ? "does not fit int64 nanoseconds" : "is not a number"),
                "check the unit in the header");
  }
  std::array<double, 8> values{};
  for (std::size_t i = 1; i < values.size(); ++i) {
    const std::string_view text = cell_text(cells[layout.columns[i]], buffer);
    const auto value = number_from(text);
    if (!value) {
      throw Error(ErrorKind::input, place, fmt::format("'{}' in column '{}' is not a finite number", text, kNames[i]),
                  "every pose must be complete; remove or mend the line");
    }
    values[i] = *value;
  }
  key.pose = {Vec3d{values[1], values[2], values[3]} * layout.metres_per_unit,
              {values[4], values[5], values[6], values[7]}};
  return key;
}

}  // namespace

double sniff_camera_csv(const CameraFile& file) {
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    std::vector<std::string_view> cells;
    split_cells(line, separator_of(line), cells);
    int found = 0;
    for (const std::string_view cell : cells) {
      const std::string name = parse_heading(cell).name;
      found += std::find(kNames.begin(), kNames.end(), name) == kNames.end() ? 0 : 1;
    }
    return found == 8 ? 1.0 : found >= 3 ? 0.5 : 0.0;
  }
  return 0.0;
}

CameraKeys read_camera_csv(const CameraFile& file, const CameraReadOptions& /*options*/) {
  CameraKeys result;
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  bool have_header = false;
  Layout layout;
  for (std::string_view line; lines.next(line);) {
    if (trim(line).empty() || trim(line).front() == '#') {
      continue;
    }
    const std::string place = fmt::format("{}:{}", file.path, lines.number());
    if (!have_header) {
      layout = parse_header(line, place);
      have_header = true;
      continue;
    }
    split_cells(line, layout.separator, cells);
    result.keys.push_back(parse_row(cells, layout, place));
    result.keys.back().row = lines.number();
  }
  return result;
}

}  // namespace gazetrace
