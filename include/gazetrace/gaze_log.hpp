// SPDX-License-Identifier: Apache-2.0
// What a gaze log is once it is read: samples, what is known of each eye and of the head, and from what it was
// concluded.
//
// Time is int64 nanoseconds on the log's own clock, never a float. Screen gaze is a fraction of the *display*:
// (0, 0) its top left edge, (1, 1) its bottom right, values outside lie beside it. Directions are unit vectors in the
// view frame: right-handed, +x right, +y up, -z forward.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_conventions.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

struct GazeSample {
  std::int64_t t_ns = 0;
  double u = 0, v = 0;        // GazeKind::screen and scene_camera
  Vec3d direction{0, 0, -1};  // GazeKind::direction
  GazeValidity validity = GazeValidity::ok;
  Eye eye = Eye::cyclopean;
  float confidence = 1.0F;  // 0..1, NaN where the log has none
  float pupil = 0.0F;       // in `GazeLog::pupil_unit`, NaN where missing
  std::int64_t row = 0;     // 1-based line (binary formats: record) in the source file
  // Coordinates are NaN where the log has none; such samples are never usable.
};

// off_screen samples are good measurements that happen to lie beside the display.
inline bool is_usable(GazeValidity v) {
  return v == GazeValidity::ok || v == GazeValidity::off_screen || v == GazeValidity::interpolated;
}

// One eye at the time of a sample, before both were made into one gaze.
struct EyeGaze {
  // (u, v, 0) or the direction, NaN where unknown.
  Vec3d at{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
           std::numeric_limits<double>::quiet_NaN()};
  float confidence = std::numeric_limits<float>::quiet_NaN();
  float pupil = std::numeric_limits<float>::quiet_NaN();
  GazeValidity validity = GazeValidity::lost;
};
struct BothEyes {
  EyeGaze left, right;
};

// Where the eyes sit in the head, in the axes of the directions; NaN where unknown.
struct EyeOrigins {
  Vec3f left_mm, right_mm;
  std::int64_t t_ns = 0;
};

// The head in the world of the recording: metres, glTF axes (the view looks along its own -z, +y up).
struct HeadPose {
  std::int64_t t_ns = 0;
  Vec3d position_m;
  Quatd orientation;
};

// "time unit" = "us", from the header: "Recording timestamp [us]".
struct GazeFact {
  std::string what;   // "time column", "time unit", "position columns", "position unit", "origin", "axes", ...
  std::string value;  // "us"
  Evidence evidence = Evidence::format;
  std::string detail;
};

enum class GazeEventType : std::uint8_t {
  fixation,
  saccade,
  blink,
  message,  // of the experiment or the tracker, `text`
  segment,  // recording runs from begin to end; between segments it was stopped
};
std::string_view to_string(GazeEventType type);

// What the log itself says happened; begin and end are inclusive and equal for messages.
struct GazeEvent {
  GazeEventType type = GazeEventType::message;
  Eye eye = Eye::cyclopean;
  std::int64_t begin_ns = 0, end_ns = 0;
  std::string text;
  std::int64_t row = 0;
};

// What a validation of the tracker measured.
struct GazeCalibration {
  std::int64_t t_ns = 0;
  Eye eye = Eye::cyclopean;
  double mean_error_deg = 0, max_error_deg = 0;  // NaN where not stated
  std::int64_t row = 0;
};

// Rows of the file against the clock, before anything was sorted or dropped; each eye's rows count for themselves.
struct GazeOrder {
  std::size_t rows = 0;
  std::size_t backward_steps = 0;
  std::int64_t longest_backward_ns = 0;
  // The first row at an earlier time than the row before it, both 1-based, and both times; 0: none.
  std::int64_t first_backward_row = 0, row_before = 0;
  std::int64_t first_backward_ns = 0, before_ns = 0;
  std::size_t duplicates = 0;            // rows of a time and an eye that were there already
  std::size_t identical_duplicates = 0;  // with the very same position
  // The first row at the time of one that was there already, and that one; 0: none.
  std::int64_t first_duplicate_row = 0, row_repeated = 0;
  std::int64_t first_duplicate_ns = 0;
};

// Another account of the same gaze in the same file: positions in other units, means of fixations by the tracker.
// Correlations of gaze x, y with its x, y, each axis oriented as the format defines that of the gaze: +1 is expected
// for xx and yy. NaN where an axis does not vary.
struct GazeWitness {
  std::string what;
  std::size_t count = 0;
  double xx = 0, yy = 0, xy = 0, yx = 0;  // xy: gaze x with its y
  std::optional<Eye> eye = std::nullopt;  // whose gaze it tells of; empty: that of all rows
};

struct GazeLog {
  GazeKind kind = GazeKind::screen;
  // Times increase. One gaze a time: of both eyes as `Conventions::eye` says.
  std::vector<GazeSample> samples;
  std::string source;            // the path as given
  std::string format;            // a name of `gaze_formats()`
  double format_confidence = 1;  // 0..1, how sure the sniffing was; 1 where the format was named
  std::string clock;             // what the log says of its clock; may be empty
  std::string pupil_unit;        // "mm", "px", "area", ...; empty: not stated
  // Geometry of the recording where the log states it (any zero field: not stated).
  std::optional<DisplayGeometry> recording_geometry;
  std::optional<Vec2d> pixels_per_degree;  // horizontally and vertically, where the log states them
  double nominal_rate_hz = 0;              // 0: not stated
  // A frame log writes the newest sample once a frame: how old a sample is, is unknown, not zero.
  bool sample_age_unknown = false;

  std::vector<BothEyes> eyes;       // empty, or one for each sample: the log has both eyes
  std::vector<EyeOrigins> origins;  // empty, or one for each sample
  std::vector<HeadPose> head;       // empty, or the head's poses with increasing times
  std::vector<GazeEvent> events;    // in the order of the file
  std::vector<GazeCalibration> calibrations;
  std::optional<Eye> stated_eye;     // a converted log's: the eye that was chosen before
  std::optional<GazeDevice> device;  // where the log states it
  // Under which the numbers of the file were read, and, in words for people, what was concluded from what.
  Conventions conventions;
  std::vector<GazeFact> facts;
  Warnings warnings;

  GazeOrder order;
  std::vector<GazeWitness> witnesses;
};

// Times in the log's own nanoseconds. A gap is a step of more than three median steps.
struct GazeTiming {
  std::int64_t first_ns = 0, last_ns = 0;
  double nominal_rate_hz = 0;  // stated by the log; 0: it does not
  double median_rate_hz = 0;   // one over the median step
  double mean_rate_hz = 0;     // of the steps that are no gaps
  double step_q1_ns = 0, step_q3_ns = 0;
  double jitter_ns = 0;  // standard deviation of the steps that are no gaps
  std::size_t gaps = 0;
  std::int64_t longest_gap_ns = 0;  // 0: none
  std::int64_t gaps_total_ns = 0;
};

}  // namespace gazetrace
