// SPDX-License-Identifier: Apache-2.0
// Reading gaze logs of all formats. gaze_log.hpp says what a log is then; gaze_raw.hpp has the steps between the file
// and the log, for those who want to see or to change them.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// An eye's columns in a table: position or direction, and what else is known of it.
struct EyeColumns {
  std::string x, y, z;
  std::string validity, confidence, pupil;
  std::string openness;                      // 0 closed to 1 open; closed is a blink
  std::string origin_x, origin_y, origin_z;  // of the eye in the head
  bool operator==(const EyeColumns&) const = default;
};

// What the user declares about the columns of a CSV or TSV that does not say it itself. A column whose name is empty
// here is found by its header. Every format that is a table takes time, x, y and z from here before its own columns.
struct GazeColumns {
  std::string time, x, y, z, validity, confidence, pupil, eye;
  EyeColumns left, right;
  // The head's pose in the same rows: position, and Euler angles in degrees (Unity's order: z, x, y) or, with w, a
  // quaternion.
  std::string head_x, head_y, head_z, head_rotation_x, head_rotation_y, head_rotation_z, head_rotation_w;
  std::string frame;  // counter of samples: rows that repeat it are dropped
  TimeUnit time_unit = TimeUnit::automatic;
  PositionUnit position_unit = PositionUnit::automatic;
  PositionOrigin origin = PositionOrigin::automatic;
  GazeAxes axes = GazeAxes::automatic;       // of directions and origins
  GazeAxes head_axes = GazeAxes::automatic;  // of the head's pose
  double origin_mm_per_unit = 1;
  double head_m_per_unit = 1;
  // "ok" values of the validity column; empty: 1, true, ok, valid (any case).
  std::vector<std::string> valid_values;
  // Where valid values are bits: all of these must be set; 0: they are not.
  std::int64_t valid_mask = 0;
  bool operator==(const GazeColumns&) const = default;
};

// A column map as JSON, `{"time": "Timeline", "time_unit": "s", "left": {"x": ...}, ...}`, names as above. Reading:
// Error(input) for unknown keys and values.
GazeColumns load_gaze_columns(const std::string& path);
void save_gaze_columns(const GazeColumns& columns, const std::string& path);
// What `over` declares replaces what `base` does.
GazeColumns merge_gaze_columns(const GazeColumns& base, const GazeColumns& over);

// What to take of a log that knows gaze in more than one frame.
//   automatic     places on a display, else directions of head-mounted displays; gaze on a scene camera's picture is
//                 refused
//   head          directions from the head: of glasses, and of logs in degrees
//   scene_camera  places on the scene camera's picture, for inspection and conversion
enum class GazeFrame { automatic, head, scene_camera };

struct GazeReadOptions {
  std::string format;  // a name of `gaze_formats()`; empty: by sniffing
  GazeColumns columns;
  // Converts pixels, lengths and degrees to fractions of the display. Logs that hold fractions do not need it.
  std::optional<DisplayGeometry> display;
  // Where the eye's perpendicular meets the display, as the user gave it; empty: `display`'s where that is not its
  // center, else what the log states.
  std::optional<Vec2d> eye_cm;
  // Used as `display` only for what neither the log nor `display` states: the screen that the gaze is to be shown on.
  std::optional<DisplayGeometry> fallback_display;
  UnorderedPolicy unordered = UnorderedPolicy::error;
  EyeChoice eye = EyeChoice::automatic;
  std::optional<Eye> dominant_eye;  // left or right; required by EyeChoice::dominant
  GazeFrame frame = GazeFrame::automatic;
  double min_confidence = std::numeric_limits<double>::quiet_NaN();  // NaN: the format's own (Pupil Core: 0.6)
  bool zero_is_missing = false;  // exactly (0, 0) is missing, whatever the validity says
  // Places whose every coordinate is exactly this number, in the log's own unit, are missing. Coordinates of -32768,
  // and of 1e7 and more, always stand for missing places.
  std::optional<double> missing_value;
  bool swap_xy = false;  // the log has its axes the wrong way round
  bool flip_x = false;   // left and right are exchanged: u becomes 1 - u, direction x becomes -x
  bool flip_y = false;   // top and bottom likewise
  // Numbers are written with a decimal comma although commas also separate the cells: the cells are joined again. Where
  // tabs or semicolons separate the cells, decimal commas are understood without this.
  bool decimal_comma = false;
  // For looking at a log only. Where pixels need the size of a display that nobody states, a usual size that holds them
  // is taken, with a warning and with `Evidence::statistics`; degrees become directions then.
  bool guess_display = false;
};

// Returns `stated`, completed by `by` where it leaves something open: the pixels, the size, or the distance together
// with the eye's place.
DisplayGeometry completed_geometry(DisplayGeometry stated, const DisplayGeometry& by);

// How a format was tried.
enum class FormatProof : std::uint8_t { recording, synthetic };
struct GazeFormatInfo {
  std::string name;
  std::string description;
  FormatProof proof = FormatProof::synthetic;  // read a real recording, or only files made after its documentation
};
std::vector<GazeFormatInfo> gaze_formats();

// A format and how sure the sniffing is that a file is of it, 0..1, the surest first; those at 0 are left out.
struct GazeFormatGuess {
  std::string name;
  double confidence = 0;
};
std::vector<GazeFormatGuess> sniff_gaze_format(const std::string& path);

// Reads a log, also one that is packed by gzip, or the recording in a folder. Error(input) with file:line for a log
// without times or without samples, for stamps that are out of order or repeated (unless sorting was asked for: then
// the last row of equal stamps is kept, and a warning counts the others), for columns and units that are not known, and
// for gaze on a scene camera's picture.
GazeLog load_gaze_log(const std::string& path, const GazeReadOptions& options);

}  // namespace gazetrace
