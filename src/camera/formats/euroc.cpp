// SPDX-License-Identifier: Apache-2.0
// EuRoC MAV ground truth (state_groundtruth_estimate0/data.csv) and trajectories in the same form: separated by commas,
// integer nanoseconds, metres, and the quaternion with w *first*; more columns (velocity, biases) may follow. The pose
// is that of the body; where the camera sits on it (T_BS of its sensor.yaml) is not in the file.
#include <fmt/format.h>

#include <array>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kForm =
    "a EuRoC line is `timestamp [ns],x,y,z [m],qw,qx,qy,qz` and may go on with velocity and biases";

bool is_header(std::string_view line) {
  return line.starts_with('#') && to_lower(line).find("timestamp") != std::string::npos;
}

}  // namespace

double sniff_camera_euroc(const CameraFile& file) {
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (is_header(line) && line.find(',') != std::string_view::npos) {
      return to_lower(line).find("q_rs_w") != std::string::npos ? 0.98 : 0.8;
    }
    if (line.empty() || line.front() == '#') {
      continue;
    }
    split_cells(line, ',', cells);
    if (cells.size() < 8 || trim(cells[0]).size() < 16) {
      return 0.0;
    }
    for (const std::string_view cell : cells) {
      if (!number_from(trim(cell))) {
        return 0.0;
      }
    }
    return 0.7;  // no header, but time stamps in nanoseconds
  }
  return 0.0;
}

CameraKeys read_camera_euroc(const CameraFile& file, const CameraReadOptions& /*options*/) {
  CameraKeys result;
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    const std::string place = fmt::format("{}:{}", file.path, lines.number());
    split_cells(line, ',', cells);
    if (is_header(line) && cells.size() > 4 && to_lower(cells[4]).find('w') == std::string::npos) {
      throw Error(ErrorKind::input, place,
                  fmt::format("column 5 is '{}', where the quaternion's w belongs", trim(cells[4]).substr(0, 40)),
                  kForm);
    }
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (cells.size() < 8) {
      throw Error(ErrorKind::input, place, fmt::format("{} values where 8 belong", cells.size()), kForm);
    }
    CameraKey key;
    key.row = lines.number();
    key.t_ns = time_at(trim(cells[0]), 0, place, kForm);
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = number_at(trim(cells[i + 1]), place, kForm);
    }
    key.pose = {{v[0], v[1], v[2]}, {v[4], v[5], v[6], v[3]}};
    result.keys.push_back(key);
  }
  return result;
}

}  // namespace gazetrace
