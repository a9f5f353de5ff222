// SPDX-License-Identifier: Apache-2.0
// Reading gaze logs of all formats. gaze_log.hpp describes the log that results; gaze_raw.hpp has the single steps from
// the file to the log, to be looked at or changed.
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

// The names of an eye's columns in a table: its position or direction, and other data of it.
struct EyeColumns {
  std::string x, y, z;
  std::string validity, confidence, pupil;
  std::string openness;                      // 0 (closed, a blink) to 1 (open)
  std::string origin_x, origin_y, origin_z;  // of the eye in the head
  bool operator==(const EyeColumns&) const = default;
};

// The user's description of the columns of a CSV or TSV whose header does not tell. A column without a name here is
// found by its header. In every format that is a table, the names of time, x, y and z given here replace its own.
struct GazeColumns {
  std::string time, x, y, z, validity, confidence, pupil, eye;
  std::string recording;  // which recording a row belongs to, where a file holds several
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
  // Values of the validity column that mean a valid sample; empty: 1, true, ok, valid (any case).
  std::vector<std::string> valid_values;
  // Where the validity column holds bits, those that must all be set in a valid sample; 0: it does not hold bits.
  std::int64_t valid_mask = 0;
  bool operator==(const GazeColumns&) const = default;
};

// A column map as JSON, `{"time": "Timeline", "time_unit": "s", "left": {"x": ...}, ...}`, with the names above as
// keys. Loading throws Error(input) for unknown keys and values.
GazeColumns load_gaze_columns(const std::string& path);
void save_gaze_columns(const GazeColumns& columns, const std::string& path);
// The declarations of both; where both declare something, `over` wins.
GazeColumns merge_gaze_columns(const GazeColumns& base, const GazeColumns& over);

// Which gaze is taken of a log that states it in more than one frame of reference.
//   automatic     places on a display, else directions of head-mounted displays; gaze on a scene camera's picture is
//                 refused
//   head          directions from the head, which eye tracking glasses and logs in degrees have
//   scene_camera  places on the scene camera's picture, which can be inspected and converted only
//   world         the directions of the log stand in the space of the head's poses, and are turned into the head
enum class GazeFrame { automatic, head, scene_camera, world };

struct GazeReadOptions {
  std::string format;  // a name of `gaze_formats()`; empty: found by the file's content
  GazeColumns columns;
  // Which recording, or which block, of a file that holds several: its number from 1 in the order of the file, or its
  // name; empty: the only one, or all blocks of it.
  std::string recording;
  // A table of fixations, saccades or blinks that another program found in this log, on the log's clock: they become
  // events of the log. Empty: none.
  std::string events_file;
  // Converts pixels, lengths and degrees to fractions of the display. Logs that hold fractions do not need it.
  std::optional<DisplayGeometry> display;
  // Where the eye's perpendicular meets the display, as the user gave it; empty: `display`'s where that is not its
  // center, else the log's.
  std::optional<Vec2d> eye_cm;
  // Used where neither the log nor `display` states it: the screen on which the pictures will be seen.
  std::optional<DisplayGeometry> fallback_display;
  UnorderedPolicy unordered = UnorderedPolicy::error;
  EyeChoice eye = EyeChoice::automatic;
  GazeFrame frame = GazeFrame::automatic;
  double min_confidence = std::numeric_limits<double>::quiet_NaN();  // NaN: the format's own (Pupil Core: 0.6)
  // Places with exactly this number in one coordinate, in the log's own unit, are missing; 0 must stand in both, and in
  // directions every number in all three. Coordinates of -32768, and of 1e7 and more, always stand for missing places.
  std::optional<double> missing_value;
  // The log's x and y of the display's top left corner, in the log's own unit, where it does not state them: with two
  // monitors side by side, (1920, 0) of the right one. Empty: (0, 0).
  std::optional<Vec2d> corner;
  bool swap_xy = false;  // x and y are exchanged in the log
  bool flip_x = false;   // left and right are exchanged: u becomes 1 - u, direction x becomes -x
  bool flip_y = false;   // top and bottom likewise
  // Accepts conventions that only the numbers decide, against all rivals; otherwise they are refused like
  // open ones.
  bool accepts_inferred = false;
  // For inspecting a log, never for rendering. Where pixels need the size of a display that is stated nowhere, a common
  // size that holds them is assumed, with a warning and with `Evidence::statistics`; degrees then become directions.
  bool guess_display = false;
  // Files of a BIDS recording, its sidecars and those of other eyes, may be symbolic links that lead out of its
  // data set. Otherwise the links are followed, and must end in it.
  bool allow_outside = false;
  std::uint64_t most_unpacked_bytes = std::numeric_limits<std::uint64_t>::max();  // that a packed log may become
};

// Returns `stated`, with missing values taken from `by`: the pixels, the size, or the distance together with the
// eye's place.
DisplayGeometry completed_geometry(DisplayGeometry stated, const DisplayGeometry& by);

// The kind of files that a format's reader was tested with.
enum class FormatProof : std::uint8_t { recording, synthetic };
struct GazeFormatInfo {
  std::string name;
  std::string description;
  FormatProof proof = FormatProof::synthetic;  // a real recording, or only files written after its documentation
};
std::vector<GazeFormatInfo> gaze_formats();

// Reads a log, also one that is packed by gzip, or the recording in a folder. Error(input) with file:line for a file of
// several recordings of which none is chosen, for a log without times or without samples, for stamps that are out of
// order or repeated (unless sorting was asked for: then the last row of equal stamps is kept, and a warning counts the
// others), for columns and units that are not known, and for gaze on a scene camera's picture.
GazeLog load_gaze_log(const std::string& path, const GazeReadOptions& options);

// The decisions about a log's numbers as a table, with the reason of each and the figures of rival readings.
std::string decisions_in_words(const std::vector<GazeFact>& facts);

}  // namespace gazetrace
