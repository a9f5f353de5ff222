// SPDX-License-Identifier: Apache-2.0
// From a path to the text of a log, and what speaks for a damaged file.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

// The file, or the recording in a folder: unpacked, as UTF-8, with line ends that are \n or \r\n. Throws Error(input)
// for a folder without a known recording, and for a text with a line that is too long for a log, before the whole of
// that line is read.
GazeFile open_log_file(const std::string& path,
                       std::uint64_t most_unpacked_bytes = std::numeric_limits<std::uint64_t>::max());

// Adds to `raw.damages` what shows that the file is not whole: bytes of value zero in a text, and a last row that is
// short and has no line end.
void note_damages(const GazeFile& file, RawGaze& raw);

}  // namespace gazetrace
