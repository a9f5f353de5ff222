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

// What the user declared about columns of a CSV/TSV that does not say it itself. Empty names: found by header. Every
// format that is a table takes time, x, y and z from here before its own.
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
  // Converts px, mm and degrees to fractions; needed only for those.
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
  // Places with exactly this in every coordinate, in the log's unit, are missing. Always so: coordinates of -32768 and
  // of 1e7 and more.
  std::optional<double> missing_value;
  bool swap_xy = false;  // the log has its axes the wrong way round
  bool flip_x = false;   // left and right are exchanged: u becomes 1 - u, direction x becomes -x
  bool flip_y = false;   // top and bottom likewise
  // Numbers are written with a decimal comma in a table that commas separate: cells are joined again. Where tabs or
  // semicolons separate, decimal commas are understood without it.
  bool decimal_comma = false;
  // For looking at a log only: where pixels need the size of a display that nobody states, a usual size that holds them
  // is taken, with a warning and a fact marked statistics; degrees become directions.
  bool guess_display = false;
};

// What `stated` leaves open (pixels, size, distance and with it the place of the eye) is that of `by`.
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

// Also gzip, and folders of recordings. Error(input) with file:line for a log without time, without samples, with
// unordered or duplicated stamps (unless sorting was asked for; then the last of equal stamps is kept and a warning
// counts them), with unknown columns or units, for gaze on a scene camera's picture.
GazeLog load_gaze_log(const std::string& path, const GazeReadOptions& options);

}  // namespace gazetrace
