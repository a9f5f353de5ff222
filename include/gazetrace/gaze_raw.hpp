// SPDX-License-Identifier: Apache-2.0
// The steps between a file and a gaze log, one by one: `read_raw_gaze` reads the numbers as they stand there,
// `conclude_conventions` decides what they mean, and `interpret` makes the log of both. `load_gaze_log` (gaze_read.hpp)
// does the three in turn. A raw gaze is never changed: the same one can be interpreted again under other conventions,
// to see what it would be then.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

// A row of the file for one eye, or for a gaze that the log itself combined.
struct RawSample {
  // The stamp, in nanoseconds, under the unit of `RawGaze::declared.time_exponent`. Every digit down to a nanosecond is
  // kept.
  std::int64_t t_ns = 0;
  // x, y and, of directions, z, in the file's own unit, axes and order; NaN where the row has none.
  Vec3d at;
  GazeValidity validity = GazeValidity::ok;  // what the row itself says of the eye
  Eye eye = Eye::cyclopean;
  float confidence = 1.0F;  // 0..1, NaN where the log has none
  float pupil = 0.0F;       // in `RawGaze::pupil_unit`, NaN where missing
  std::int64_t row = 0;     // 1-based line (binary formats: record) in the source file
};

// From a row of the file on, the x and y of the display's top left corner.
struct CornerFromRow {
  std::size_t first_row = 0;  // an index into `RawGaze::rows`
  Vec2d corner;
};

// Something that is wrong with the file itself, that was passed over, and that an option mends. `load_gaze_log` refuses
// such a log.
struct RawFault {
  std::string code;   // "media", "decimal-commas"
  std::string place;  // file:line
  std::string problem;
  std::string remedy;
  std::string flag;   // the option under which reading does what was done here; empty: there is none
  std::string found;  // the same problem as a finding of an inspection
};

struct RawGaze {
  GazeKind kind = GazeKind::screen;  // what the places are of
  std::vector<RawSample> rows;       // in the order of the file
  std::string source, format;
  double format_confidence = 1;
  std::string clock, pupil_unit;
  double nominal_rate_hz = 0;
  bool sample_age_unknown = false;
  std::optional<DisplayGeometry> recording_geometry;
  std::optional<Vec2d> pixels_per_degree;
  std::optional<Vec2d> picture_px;  // size of the scene camera's picture
  std::optional<Eye> stated_eye;
  std::optional<GazeDevice> device;
  // In the file's axes; they need not be aligned with the rows.
  std::vector<EyeOrigins> origins;
  std::vector<HeadPose> head;  // in gazetrace's axes
  std::vector<GazeEvent> events;
  std::vector<GazeCalibration> calibrations;
  // Signs as the format defines them; `interpret` turns them with the gaze.
  std::vector<GazeWitness> witnesses;

  // What the format, the header, a sidecar or the named columns say of the numbers. `automatic`: nothing does.
  Conventions declared;
  // Where the file moves the display's corner between its rows, in their order: before the first of these rows
  // `Conventions::corner` holds. Empty: it holds for all rows.
  std::vector<CornerFromRow> corners;
  // Degrees that become directions grow up, whatever the origin is that the columns, or a guess, have for them. Else
  // they grow down where they count from the top left.
  bool directions_grow_up = false;
  std::string place;            // file:line where that stands, for messages
  std::string way_out;          // of gaze on a scene camera's picture: what could be read instead
  std::vector<GazeFact> notes;  // what else the file says, in words
  std::vector<RawFault> faults;
  Warnings warnings;
};

// Of a file, also gzip, or of a folder. `options` say which format and which columns; nothing is converted.
// Error(input) with file:line for what is no log, for broken rows, and for columns or units that are not known.
RawGaze read_raw_gaze(const std::string& path, const GazeReadOptions& options);

// What `options` say wins over what the log declares, with a warning; what nobody says is guessed from the numbers,
// with a warning. Error(input) for gaze on a scene camera's picture unless `options.frame` asks for it.
Conventions conclude_conventions(const RawGaze& raw, const GazeReadOptions& options);

// The same raw gaze and the same conventions give the same log, bit by bit. Error(input) with file:line for a log
// without samples, with unordered or repeated stamps (unless they are to be sorted), and for positions whose unit needs
// a display that is not known; Error(usage) for an eye that the log does not have, and for an automatic unit.
GazeLog interpret(const RawGaze& raw, const Conventions& conventions);

}  // namespace gazetrace
