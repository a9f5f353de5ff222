// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D trajectories: `timestamp tx ty tz qx qy qz qw`, separated by blanks, in seconds and metres, `#` comments.
#include <fmt/format.h>

#include <array>
#include <cmath>

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
    double square = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto value = number_from(cells[i]);
      if (!value) {
        return 0.0;
      }
      square += i < 4 ? 0 : *value * *value;
    }
    // Nuke's lines may have eight numbers, too, but no quaternion among them.
    return std::abs(square - 1) < 0.1 ? 0.9 : 0.5;
  }
  return 0.0;
}

CameraKeys read_camera_tum(const CameraFile& file, const CameraReadOptions& /*options*/) {
  CameraKeys result;
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
    key.t_ns = time_at(cells[0], 9, place, kForm);
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = number_at(cells[i + 1], place, kForm);
    }
    key.pose = {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
    result.keys.push_back(key);
  }
  return result;
}

}  // namespace gazetrace
