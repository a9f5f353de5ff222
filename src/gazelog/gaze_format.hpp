// SPDX-License-Identifier: Apache-2.0
// A gaze format is one file in formats/ with a sniffer and a reader, and one line in formats.def.
#pragma once

#include <string>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

struct GazeFile {
  std::string path;  // for sidecars and messages
  std::string text;  // unpacked; UTF-8 without a byte-order mark, or the bytes of a binary format
};

struct GazeFormat : GazeFormatInfo {
  double (*sniff)(const GazeFile& file);  // how sure it is, 0..1
  // Reads the rows in the order of the file, one for each eye and each combined gaze of the log, with their numbers as
  // they stand in the file, and what the file says about them.
  RawGaze (*read)(const GazeFile& file, const GazeReadOptions& options);
};

// The part of a file that the sniffers look at.
inline std::string_view head_of(const GazeFile& file, std::size_t bytes = 65536) {
  return std::string_view(file.text).substr(0, bytes);
}

inline std::string_view first_line_of(const GazeFile& file) {
  return head_of(file).substr(0, file.text.find('\n'));
}
// Whether a text has a word, for sniffers that ask for several.
struct WordsIn {
  std::string_view text;
  bool operator()(std::string_view word) const { return text.find(word) != std::string_view::npos; }
};

}  // namespace gazetrace
