// SPDX-License-Identifier: Apache-2.0
// What a camera path reader hands over: poses as the file has them, before any axes preset.
#pragma once

#include <cstdint>
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

struct CameraFile {
  std::string path;
  std::string text;  // UTF-8, without a byte-order mark
};

struct CameraFormat {
  std::string name;
  std::string description;
  double (*sniff)(const CameraFile& file);  // how sure, 0..1
  std::vector<CameraKey> (*read)(const CameraFile& file, Warnings& warnings);
};

}  // namespace gazetrace
