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

// Tables that trackers and analysis programs write beside gaze: fixations, saccades and blinks with one row for each,
// corners of surfaces, movements of the head. Their columns of time and place look like gaze (event_table.cpp).

// Throws Error(input) for a table that holds no gaze, saying what it holds and what it is good for. `is_named`: the
// user names the format, so that only what is certain is refused.
void refuse_other_tables(const GazeFile& file, bool is_named);

// The events of a table with one row for each. Throws Error(input) for a file that is no such table.
std::vector<GazeEvent> read_event_table(const std::string& path);

// Makes the events of the table at `path` events of the log. Those of the same types that the log states itself give
// way to them, with a warning; those that do not touch the log's time are left out, with a warning.
void take_events(const std::string& path, RawGaze& raw);

// Packed logs (gzip.cpp).

bool is_gzip(std::string_view bytes);
// Unpacks all members of a gzip file. Throws Error(input) at `path` for damaged or cut data, and for data that unpack
// to more than `most_bytes` or more than any recording does (400 times their size and 16 MiB).
std::string unpack_gzip(std::string_view bytes, const std::string& path, std::uint64_t most_bytes);

// Packs one member without name and time, so that the same text gives the same bytes.
std::string pack_gzip(std::string_view text);

}  // namespace gazetrace
