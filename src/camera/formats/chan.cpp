// SPDX-License-Identifier: Apache-2.0
// Nuke channel files: `frame tx ty tz rx ry rz [vertical field of view]`, separated by blanks or tabs, with angles in
// degrees; the camera looks along -z with y up. The file does not state the order of the rotations; Nuke's default is
// z, x, y.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kForm = "a line of a .chan file is `frame tx ty tz rx ry rz [vfov]`, angles in degrees";

}  // namespace

double sniff_camera_chan(const CameraFile& file) {
  const bool named = to_lower(file.path).ends_with(".chan");
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    split_cells(line, ' ', cells);
    for (const std::string_view cell : cells) {
      if (!number_from(cell)) {
        return 0.0;
      }
    }
    const bool counted = cells[0].find_first_of(".eE,") == std::string_view::npos;
    if (!counted || cells.size() < 7 || cells.size() > 8) {
      return 0.0;
    }
    return named ? 0.98 : cells.size() == 7 ? 0.7 : 0.6;
  }
  return 0.0;
}

CameraKeys read_camera_chan(const CameraFile& file, const CameraReadOptions& options) {
  CameraKeys result;
  result.counts_frames = true;
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  std::vector<double> yfovs_rad;
  std::int64_t first = 0;
  std::int64_t last = 0;
  for (std::string_view line; lines.next(line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    const std::string place = fmt::format("{}:{}", file.path, lines.number());
    split_cells(line, ' ', cells);
    if (cells.size() < 7 || cells.size() > 8) {
      throw Error(ErrorKind::input, place, fmt::format("{} values where 7 or 8 belong", cells.size()), kForm);
    }
    // Only whole numbers are frames, but they may be written as 12.0.
    const auto number = number_from(cells[0]);
    if (!number || *number != std::trunc(*number) || std::abs(*number) > 2e9) {
      throw Error(ErrorKind::input, place, fmt::format("'{}' is not a frame number", cells[0].substr(0, 40)), kForm);
    }
    const auto frame = static_cast<std::int64_t>(*number);
    if (!result.keys.empty() && frame <= last) {
      throw Error(ErrorKind::input, place,
                  fmt::format("frame {} {} {}", frame, frame == last ? "repeats" : "comes after", last),
                  "frames of a .chan file must increase");
    }
    first = result.keys.empty() ? frame : first;
    last = frame;
    std::array<double, 7> v{};
    for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
      v[i] = number_at(cells[i + 1], place, kForm);
    }
    if (cells.size() == 8) {
      if (!(v[6] > 0 && v[6] < 180)) {
        throw Error(ErrorKind::input, place,
                    fmt::format("a field of view of {} degrees is not between 0 and 180", v[6]), kForm);
      }
      yfovs_rad.push_back(v[6] * kRadPerDeg);
    }
    CameraKey key;
    key.row = lines.number();
    key.t_ns = frame_time_at(frame, first, options, place);
    key.pose = {{v[0], v[1], v[2]}, quaternion_of_euler(Vec3d{v[3], v[4], v[5]} * kRadPerDeg, options.rotation_order)};
    result.keys.push_back(key);
  }
  result.yfov_rad = one_field_of_view(yfovs_rad, file.path, result.warnings);
  return result;
}

}  // namespace gazetrace
