// SPDX-License-Identifier: Apache-2.0
// What the reader of a camera path format returns: poses as they are in the file, before their axes are converted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/camera.hpp"

namespace gazetrace {

struct CameraKey {
  std::int64_t t_ns = 0;
  CameraPose pose;  // the quaternion as it is in the file, of any length
  std::int64_t row = 0;
};

struct CameraKeys {
  std::vector<CameraKey> keys;
  CameraAxes axes = CameraAxes::gl;  // the format's own
  bool counts_frames = false;        // times were made from frame numbers; they are not moved to begin at 0
  std::optional<double> yfov_rad;
  Warnings warnings;
};

struct CameraFile {
  std::string path;
  std::string text;  // UTF-8, without a byte-order mark
};

struct CameraFormat {
  std::string name;
  std::string description;
  double (*sniff)(const CameraFile& file);  // how likely the file is of this format, 0..1
  CameraKeys (*read)(const CameraFile& file, const CameraReadOptions& options);
};

// Helpers that readers share. `form` describes a line of the format, and is the remedy in error messages.
double number_at(std::string_view text, const std::string& place, std::string_view form);
std::int64_t time_at(std::string_view text, int exponent, const std::string& place, std::string_view form);
// The time of the middle of frame `number`, where the file's first frame is `first`; see CameraReadOptions::fps and
// keep_time. Error(input) where it does not fit int64.
std::int64_t frame_time_at(std::int64_t number, std::int64_t first, const CameraReadOptions& options,
                           const std::string& place);
// Orders pictures by name, with numbers in the names compared by value: frame_9 before frame_10.
bool natural_less(std::string_view a, std::string_view b);
// The first of the fields of view that a file states, since a path has only one; with a warning where they differ by
// more than a thousandth of a degree. Empty where there are none. Error(input) for one that is not between 0 and 180
// degrees.
std::optional<double> one_field_of_view(const std::vector<double>& yfovs_rad, const std::string& path,
                                        Warnings& warnings);

}  // namespace gazetrace
