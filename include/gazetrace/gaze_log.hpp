// SPDX-License-Identifier: Apache-2.0
// A gaze log after reading: its samples, the data of each eye and of the head, and the evidence for
// how the file was interpreted.
//
// Time is int64 nanoseconds on the log's own clock, never a float. Gaze on a screen is a fraction of the *display*:
// (0, 0) is its top left corner and (1, 1) its bottom right corner, and values outside 0..1 lie beside the display.
// Directions are unit vectors in the view frame: right-handed, +x right, +y up, -z forward.
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
  std::int64_t row = 0;     // 1-based line (in binary formats: record) of the source file
  // Coordinates are NaN where the log has none; such samples are never usable.
};

// off_screen samples are good measurements that happen to lie beside the display.
inline bool is_usable(GazeValidity v) {
  return v == GazeValidity::ok || v == GazeValidity::off_screen || v == GazeValidity::interpolated;
}

// One eye at the time of a sample, before both eyes were combined into one gaze.
struct EyeGaze {
  // (u, v, 0) or the direction; NaN where unknown.
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

// The pose of the head in the world of the recording, in metres and in the axes of glTF (the view looks along its own
// -z, with +y up).
struct HeadPose {
  std::int64_t t_ns = 0;
  Vec3d position_m;
  Quatd orientation;
};

// One thing that was concluded about the file: for example "time unit" is "us", from the header "Recording timestamp
// [us]".
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
  message,  // of the experiment or the tracker; its words are in `text`
  segment,  // the recording ran from begin to end; between segments it was stopped
  trial,    // a part of the recording that was named when it was imported; its name is in `text` and may be empty
  aoi,      // gaze lay in an area of interest that the log names in `text`
};
std::string_view to_string(GazeEventType type);

// Something that happened according to the log itself. Begin and end are both inclusive, and equal for messages.
struct GazeEvent {
  GazeEventType type = GazeEventType::message;
  Eye eye = Eye::cyclopean;
  std::int64_t begin_ns = 0, end_ns = 0;
  std::string text;
  std::int64_t row = 0;
  // Other values of the tracker, in its own reckoning: a duration may count the last sample's own time, and a
  // velocity has the tracker's filter behind it.
  std::optional<std::int64_t> stated_duration_ns = std::nullopt;
  std::optional<double> stated_amplitude_deg = std::nullopt, stated_peak_velocity_deg_s = std::nullopt;
};

// One of the recordings that a file holds, or one block of its only recording.
struct GazeRecording {
  std::string name;            // as the file names it, which may identify a person; empty: the file only counts them
  bool is_block = false;       // blocks stand on one clock, so that a log may hold several; recordings do not
  std::size_t rows = 0;        // rows of the file, one for each eye
  std::int64_t first_row = 0;  // 1-based line of the file where it begins
  std::int64_t first_ns = 0, last_ns = 0;  // of its rows, on the clock of the file
};

// The errors that a validation of the tracker measured.
struct GazeCalibration {
  std::int64_t t_ns = 0;
  Eye eye = Eye::cyclopean;
  double mean_error_deg = 0, max_error_deg = 0;  // NaN where not stated
  std::int64_t row = 0;
};

// How the rows of the file stand in time, before anything was sorted or dropped. The rows of each eye are counted
// separately.
struct GazeOrder {
  std::size_t rows = 0;
  std::size_t backward_steps = 0;
  std::int64_t longest_backward_ns = 0;
  // The first row at an earlier time than the row before it, and that row before it (both 1-based), with the times of
  // both; 0: there is none.
  std::int64_t first_backward_row = 0, row_before = 0;
  std::int64_t first_backward_ns = 0, before_ns = 0;
  std::size_t duplicates = 0;            // rows whose time and eye an earlier row has already
  std::size_t identical_duplicates = 0;  // those of them with exactly the same position
  // The first row that repeats the time of an earlier row, and that earlier row; 0: there is none.
  std::int64_t first_duplicate_row = 0, row_repeated = 0;
  std::int64_t first_duplicate_ns = 0;
};

// Another account of the same gaze in the same file, such as positions in other units or the tracker's means of
// fixations. xx to yx are the correlations of the gaze's x and y with the witness's x and y, each axis oriented as the
// format defines that of the gaze, so that +1 is expected for xx and yy. NaN where an axis does not vary.
struct GazeWitness {
  std::string what;
  std::size_t count = 0;
  double xx = 0, yy = 0, xy = 0, yx = 0;  // xy: x of the gaze with y of the witness
  std::optional<Eye> eye = std::nullopt;  // the eye whose gaze it describes; empty: that of all rows
};

// A part of a recording, see gaze_trials.hpp. Both ends are included.
struct GazeTrial {
  std::int32_t number = 1;  // from 1, in the order of time
  std::string name;         // its name in the recording or the table; may be empty
  std::int64_t begin_ns = 0, end_ns = 0;
  std::int32_t block = 0;  // number of the block of the recording that it begins in, from 1; 0: in none
};

// The statements of a recording beside its gaze. They stay as they are however its numbers are interpreted.
struct GazeRecord {
  GazeKind kind = GazeKind::screen;
  std::string source;            // the path as given
  std::string format;            // a name of `gaze_formats()`
  double format_confidence = 1;  // 0..1, how sure the sniffing was; 1 where the format was named
  std::string clock;             // the log's words about its clock; may be empty
  std::string pupil_unit;        // "mm", "px", "area", ...; empty: not stated
  // Geometry of the recording where the log states it (any zero field: not stated).
  std::optional<DisplayGeometry> recording_geometry;
  std::optional<Vec2d> pixels_per_degree;  // horizontally and vertically, where the log states them
  double nominal_rate_hz = 0;              // 0: not stated
  // A frame log writes the newest sample once in each frame: the age of its samples is then unknown rather than zero.
  bool sample_age_unknown = false;
  std::vector<EyeOrigins> origins;
  std::vector<HeadPose> head;
  std::vector<GazeEvent> events;  // in the order of the file
  std::vector<GazeCalibration> calibrations;
  std::optional<Eye> stated_eye;     // of a converted log: the eye that was chosen when it was converted
  std::optional<GazeDevice> device;  // where the log states it
  std::vector<GazeWitness> witnesses;
  // The recordings of the file, or the blocks of its only one, in the order of the file; empty where there is but one.
  std::vector<GazeRecording> recordings;
  std::size_t recording = 0;  // which of them these are, counted from 1; 0: all that the file has
  Warnings warnings;
};

// `origins` are empty, or one for each sample; `head` is empty, or has poses with increasing times.
struct GazeLog : GazeRecord {
  // Times increase. There is one gaze for each time, made from both eyes as `Conventions::eye` says.
  std::vector<GazeSample> samples;
  std::vector<BothEyes> eyes;  // one for each sample where the log has both eyes; else empty
  // The conventions under which the numbers of the file were interpreted, and the same in words for people, with the
  // evidence for each.
  Conventions conventions;
  std::vector<GazeFact> facts;
  GazeOrder order;
  std::optional<GazeTrial> trial;  // where the log was cut to one
};

// Whether each sample has its two eyes.
inline bool has_both_eyes(const GazeLog& log) {
  return !log.eyes.empty() && log.eyes.size() == log.samples.size();
}

// Times in the log's own nanoseconds. A gap is a step of more than three median steps, unless the recording was stopped
// there: then it is a pause.
struct GazeTiming {
  std::int64_t first_ns = 0, last_ns = 0;
  double nominal_rate_hz = 0;  // stated by the log; 0: not stated
  double median_rate_hz = 0;   // one over the median step
  double mean_rate_hz = 0;     // one over the mean of the steps that are no gaps
  double step_q1_ns = 0, step_q3_ns = 0;
  double jitter_ns = 0;  // standard deviation of the steps that are no gaps
  std::size_t gaps = 0;
  std::int64_t longest_gap_ns = 0;  // 0: none
  std::int64_t gaps_total_ns = 0;
  std::size_t pauses = 0;
  std::int64_t pauses_total_ns = 0;
};

}  // namespace gazetrace
