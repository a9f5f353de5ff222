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

struct DecimalCommas {
  enum class Status : std::uint8_t {
    none,       // rows have no more cells than there are columns
    found,      // `fractions` is the only reading that fits all rows
    ambiguous,  // there are more cells than columns, and no reading of them is certain
  };
  Status status = Status::none;
  std::vector<bool> fractions;  // for each column: whether its numbers stand in two cells
};

// Decided from the first rows below a comma-separated header, or below @DATA. A cell that begins with a needless 0
// ("05") or is longer than any whole number can only be a fraction. A cell with a sign or without digits can only begin
// a number. Where several readings are left, the one in which the columns change the least from row to row wins, if the
// difference is clear.
DecimalCommas find_decimal_commas(const GazeFile& file);

// Throws Error(input) where commas separate the cells and also group the digits of some numbers: rows hold more cells
// than there are columns, but only those whose numbers are large.
void refuse_thousands(const GazeFile& file);

// Whether numbers that decimal commas split into two cells are joined again even where nobody declared decimal commas.
// Each mending is reported in `RawGaze::faults`.
enum class Mending { none, decimal_commas };
RawGaze read_raw_gaze(const std::string& path, const GazeReadOptions& options, Mending mending);

}  // namespace gazetrace
