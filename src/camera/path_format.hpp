// SPDX-License-Identifier: Apache-2.0
// What a camera path reader hands over: poses as the file has them, before any axes preset.
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
  CameraPose pose;  // orientation as written, of any length
  std::int64_t row = 0;
};

struct CameraKeys {
  std::vector<CameraKey> keys;
  CameraAxes axes = CameraAxes::gl;  // the format's own
  bool counts_frames = false;        // times are middles of frames, and stay as they are
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
  double (*sniff)(const CameraFile& file);  // how sure, 0..1
  CameraKeys (*read)(const CameraFile& file, const CameraReadOptions& options);
};

// Parts that readers share. `form` is the remedy: what a line of the format is.
double number_at(std::string_view text, const std::string& place, std::string_view form);
std::int64_t time_at(std::string_view text, int exponent, const std::string& place, std::string_view form);
// The middle of frame `number` where the file's first is `first`. Error(input) beyond int64.
std::int64_t frame_time_at(std::int64_t number, std::int64_t first, const CameraReadOptions& options,
                           const std::string& place);
// Frames in the order of their pictures' names, numbers in them by value: frame_9 before frame_10.
bool natural_less(std::string_view a, std::string_view b);
// One of the fields of view that a file states, in order, of which a path can have one: the first, with a warning where
// they differ by more than a thousandth of a degree. Empty for none. Throws Error(input) for one that is not
// between 0 and 180 degrees.
std::optional<double> one_field_of_view(const std::vector<double>& yfovs_rad, const std::string& path,
                                        Warnings& warnings);

}  // namespace gazetrace
