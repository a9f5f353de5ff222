// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D trajectories: `timestamp tx ty tz qx qy qz qw`, blanks between, seconds and metres, `#` comments.
#include <fmt/format.h>

#include <array>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {

double sniff_camera_tum(const CameraFile& file) {
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    split_cells(line, ' ', cells);
    if (cells.size() != 8) {
      return 0.0;
    }
    for (const std::string_view cell : cells) {
      if (!number_from(cell)) {
        return 0.0;
      }
    }
    return 0.9;
  }
  return 0.0;
}

std::vector<CameraKey> read_camera_tum(const CameraFile& file, Warnings& /*warnings*/) {
  std::vector<CameraKey> keys;
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  constexpr std::string_view kForm = "a TUM line is `t tx ty tz qx qy qz qw`, in seconds and metres";
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    const std::string place = fmt::format("{}:{}", file.path, lines.number());
    split_cells(line, ' ', cells);
    if (cells.size() != 8) {
      throw Error(ErrorKind::input, place, fmt::format("{} values where 8 belong", cells.size()), kForm);
    }
    CameraKey key;
    key.row = lines.number();
    const NumberStatus status = scaled_integer(cells[0], 9, key.t_ns);
    if (status != NumberStatus::ok) {
      throw Error(
          ErrorKind::input, place,
          fmt::format("time '{}' {}", cells[0],
                      status == NumberStatus::overflow ? "in s does not fit int64 nanoseconds" : "is not a number"),
          kForm);
    }
    std::array<double, 7> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value = number_from(cells[i + 1]);
      if (!value) {
        throw Error(ErrorKind::input, place, fmt::format("'{}' is not a finite number", cells[i + 1]), kForm);
      }
      values[i] = *value;
    }
    key.pose = {{values[0], values[1], values[2]}, {values[3], values[4], values[5], values[6]}};
    keys.push_back(key);
  }
  return keys;
}

}  // namespace gazetrace
