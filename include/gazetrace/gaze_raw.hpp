// SPDX-License-Identifier: Apache-2.0
// The single steps from a file to a gaze log: `read_raw_gaze` reads the numbers as they are written,
// `conclude_conventions` decides their meaning, and `interpret` makes the log from both. `load_gaze_log`
// (gaze_read.hpp) does the three in turn. A raw gaze is never changed, so that it can be interpreted again under other
// conventions and compares the resulting logs.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_raw_rows.hpp"
#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

// The x and y that the display's top left corner has from a row of the file on, and the display's size.
struct CornerFromRow {
  std::size_t first_row = 0;  // an index into `RawGaze::rows`
  Vec2d corner;
  std::array<int, 2> size_px{};  // 0: not stated
};

// From this line of the file on, everything belongs to one recording: an index into `RawGaze::recordings`. Origins and
// poses of the head have no line; of each there were so many when the recording began.
struct RecordingFromLine {
  std::int64_t line = 0;
  std::size_t recording = 0;
  std::size_t origins = 0, head = 0;
};

// A fault of the file itself, which `read_raw_gaze` passed over and which an option mends. `load_gaze_log` refuses a
// log with such a fault.
struct RawFault {
  std::string code;   // "media", "decimal-commas"
  std::string place;  // file:line
  std::string problem;
  std::string remedy;
  std::string setting;  // the option by which reading repeats this step, in back quotes; empty: there is none
  std::string found;    // the same problem as a finding of an inspection
};

// `kind` says whether rows hold places on a display or on a picture, or directions. `origins` are in the file's axes
// and need not be aligned with the rows; `head` is in gazetrace's axes. `witnesses` have the signs that the format
// defines: `interpret` turns them together with the gaze.
struct RawGaze : GazeRecord {
  RawRows rows;                     // in the order of the file
  std::optional<Vec2d> picture_px;  // size of the scene camera's picture

  // Statements of the format, the header, a sidecar or the named columns about the numbers. `automatic`: none of them
  // does.
  Conventions declared;
  // Where the display's corner moves between the rows of the file, in the order of the rows. Before the first of these
  // rows it is at `Conventions::corner`; if this is empty, it is there for all rows.
  std::vector<CornerFromRow> corners;
  // Where each of the recordings begins or goes on, in the order of the lines.
  std::vector<RecordingFromLine> recording_lines;
  // Degrees that become directions grow upwards, for any stated or guessed origin. If this is false, they
  // grow downwards where they count from the top left.
  bool directions_grow_up = false;
  std::int64_t clock_restarts_row = 0;  // the first row from which on the clock counts anew; 0: there is none
  // Of each block where they differ, horizontally and vertically.
  std::vector<Vec2d> pixels_per_degree_of_blocks;
  bool is_own_table = false;    // a table that no format defines: nothing about its numbers is certain by itself
  bool are_points = false;      // directions are written as points in space, of any length
  std::string place;            // file:line where `declared` is stated, for messages
  std::string way_out;          // for gaze on a scene camera's picture: another file to read
  std::vector<GazeFact> notes;  // other statements of the file, in words
  std::vector<RawFault> faults;
  Warnings damages;  // signs that the file is not whole; no option repairs it
};

// Reads a file, which may be packed by gzip, or the recording in a folder. `options` name the format, the columns and
// the recording; nothing is converted. Where the file holds several recordings and the options name none of them, it
// gives the rows of all of them, which `load_gaze_log` refuses. Throws Error(input) with file:line for a file that is
// no log, for broken rows, and for columns, units or recordings that are not known.
RawGaze read_raw_gaze(const std::string& path, const GazeReadOptions& options);

// `options` override the log's statements, with a warning. Conventions that neither states are taken from the numbers.
// The result's `doubts` list open and contradicted readings: every command checks them. Throws
// Error(input) for gaze on a scene camera's picture, unless `options.frame` asks for it.
Conventions conclude_conventions(const RawGaze& raw, const GazeReadOptions& options);

// The same raw gaze and the same conventions give the same log, bit by bit. Throws Error(input) with file:line for a
// log without samples, for stamps out of order or repeated (unless they are to be sorted), and for positions whose unit
// needs a display that is not known; Error(usage) for an eye that the log does not have, and where the unit is
// automatic.
GazeLog interpret(const RawGaze& raw, const Conventions& conventions);

}  // namespace gazetrace
