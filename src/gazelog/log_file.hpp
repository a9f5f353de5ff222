// SPDX-License-Identifier: Apache-2.0
// From a path to the text of a log, and what speaks for a damaged file.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gazelog/gaze_format.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// The file, or the recording in a folder: unpacked, as UTF-8, with line ends that are \n or \r\n. Throws Error(input)
// for a folder without a known recording, and for a text with a line that is too long for a log, before the whole of
// that line is read.
GazeFile open_log_file(const std::string& path,
                       std::uint64_t most_unpacked_bytes = std::numeric_limits<std::uint64_t>::max());

// Adds to `raw.damages` what shows that the file is not whole: bytes of value zero in a text, and a last row that is
// short and has no line end.
void note_damages(const GazeFile& file, RawGaze& raw);

// For files that no format claims. Throws Error(input) naming what the file is and the way out: binary recordings,
// archives, JSON.
void refuse_foreign_file(const GazeFile& file);
// Likewise for texts that are no table.
void refuse_prose(const GazeFile& file);

// Loggers of game engines write a vector or a quaternion into one cell, "(0.1, -0.2, 0.9)". Such cells become one for
// each component, and their headings get _x, _y, _z and _w; the lines stay where they are. Throws Error(input) for
// cells that hold the samples of a whole trial.
void split_vector_cells(GazeFile& file);

// Throws Error(input) where commas separate the cells and stand in numbers as well, as decimal marks or between
// thousands: rows hold more cells than there are columns.
void refuse_split_numbers(const GazeFile& file);

}  // namespace gazetrace
