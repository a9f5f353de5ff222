// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D trajectories: `timestamp tx ty tz qx qy qz qw`, separated by blanks, in seconds and metres, `#` comments.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

// Beyond it int64 has no nanoseconds, and there is no recording: it is the year 2237.
constexpr double kMostStamp_s = 8.4e9;
// Between two poses of a camera that moves.
constexpr double kMostStep_s = 1000;

// ORB-SLAM3 among others writes nanoseconds. Clocks tell their unit by the number of digits, and times that begin at 0
// by their steps.
void refuse_stamps_of_other_units(const std::vector<double>& stamps_s, const std::string& path) {
  double last_s = 0;
  double step_s = stamps_s.size() > 1 ? std::numeric_limits<double>::infinity() : 0;
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    last_s = std::max(last_s, std::abs(stamps_s[i]));
    step_s = i > 0 ? std::min(step_s, stamps_s[i] - stamps_s[i - 1]) : step_s;
  }
  if (last_s < kMostStamp_s && step_s < kMostStep_s) {
    return;
  }
  const bool clock = last_s >= kMostStamp_s;
  constexpr double kUsualStep_s = 10;  // the largest unit by which a step is no longer
  const double told = clock ? last_s : step_s;
  const char* unit = told >= (clock ? 1e17 : 1e6 * kUsualStep_s)   ? "nanoseconds"
                     : told >= (clock ? 1e14 : 1e3 * kUsualStep_s) ? "microseconds"
                                                                   : "milliseconds";
  throw Error(ErrorKind::input, path,
              fmt::format("its time stamps look like {}, where TUM has seconds: {}", unit,
                          clock ? fmt::format("the last is {:.0f}", last_s)
                                : fmt::format("they are {:.0f} or more apart", step_s)),
              "convert them to seconds");
}

}  // namespace

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
  std::vector<double> stamps_s;
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
    const double t_s = number_from(cells[0]).value_or(0);
    stamps_s.push_back(t_s);
    CameraKey key;
    key.row = lines.number();
    key.t_ns = std::abs(t_s) < kMostStamp_s ? time_at(cells[0], 9, place, kForm) : 0;
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = number_at(cells[i + 1], place, kForm);
    }
    key.pose = {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
    result.keys.push_back(key);
  }
  refuse_stamps_of_other_units(stamps_s, file.path);
  return result;
}

}  // namespace gazetrace
