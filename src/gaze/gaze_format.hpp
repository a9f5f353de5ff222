// SPDX-License-Identifier: Apache-2.0
// What a gaze format is: one file in formats/ with a sniffer and a reader, one line in formats.def.
#pragma once

#include <string>

#include "gazetrace/gaze.hpp"

namespace gazetrace {

struct GazeFile {
  std::string path;  // for sidecars and messages
  std::string text;  // UTF-8, without a byte-order mark
};

struct GazeFormat {
  std::string name;
  std::string description;
  double (*sniff)(const GazeFile& file);  // how sure, 0..1
  // Samples in the order of the file; `finish_log` checks and orders them.
  GazeLog (*read)(const GazeFile& file, const GazeReadOptions& options);
};

}  // namespace gazetrace
