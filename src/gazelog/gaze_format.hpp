// SPDX-License-Identifier: Apache-2.0
// What a gaze format is: one file in formats/ with a sniffer and a reader, one line in formats.def.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

struct GazeFile {
  std::string path;  // for sidecars and messages
  std::string text;  // unpacked; UTF-8 without a byte-order mark, or the bytes of a binary format
  // Columns whose numbers a decimal comma splits into two cells; empty: none.
  std::vector<bool> fractions = {};
};

struct GazeFormat {
  std::string name;
  FormatProof proof;
  std::string description;
  double (*sniff)(const GazeFile& file);  // how sure, 0..1
  // Rows in the order of the file, one for each eye and each combined gaze of the log, with their numbers as they stand
  // there, and what the file says of them.
  RawGaze (*read)(const GazeFile& file, const GazeReadOptions& options);
};

// The part of a file that sniffing looks at.
inline std::string_view head_of(const GazeFile& file, std::size_t bytes = 65536) {
  return std::string_view(file.text).substr(0, bytes);
}

}  // namespace gazetrace
