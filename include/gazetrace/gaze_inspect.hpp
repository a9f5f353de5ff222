// SPDX-License-Identifier: Apache-2.0
// The log doctor reports how good a gaze log is, its suspicious points with their evidence, and which
// options mend it. Nothing here changes a log.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/gaze_raw.hpp"
#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

// How many samples can be used. The time of a loss is the time from one usable sample to the next, less one median
// step; at either end of a section it is the time to the section's first or last sample. A section is a part recorded
// without a pause, and pauses are no losses.
struct GazeLoss {
  std::size_t samples = 0, usable = 0;
  std::array<std::size_t, 6> by_validity{};       // in the order of GazeValidity
  std::optional<double> left_share, right_share;  // share of the samples usable for each eye; for binocular logs
  std::size_t blink_like = 0;  // losses of 50..500 ms, the window of pymovements after Nystrom (2024)
  double blink_like_median_ms = 0;
  std::size_t longer = 0;  // losses above 500 ms
  std::int64_t longest_ns = 0;
  // At the beginning and at the end of the log; of a log without a usable sample all of it is leading.
  std::int64_t leading_ns = 0, trailing_ns = 0;
  std::int64_t last_usable_row = 0, first_usable_row = 0;  // 1-based lines; 0: there is none
};

// Runs in which the position stays the same, bit by bit, over at least five samples and 100 ms. They come from data
// that are held while the eye is lost, or from a logger that is faster than its tracker.
struct GazeFrozen {
  std::size_t runs = 0, samples = 0;
  std::int64_t longest_ns = 0;
  std::int64_t longest_row = 0;  // 1-based line where the longest begins
  double repeated_share = 0;     // usable samples that repeat the one before
};

// Noise within fixations, which for this purpose are stretches of at least 100 ms below 30 deg/s, with the velocity
// taken over 20 ms. The values are medians over the stretches: the RMS of the distances from sample to sample, and the
// root of the summed variances of both axes (Holmqvist et al. 2012). Where angles are unknown the picture counts as 40
// degrees wide for the threshold alone, and the values are in pixels or in fractions of the picture.
struct GazePrecision {
  std::size_t fixations = 0;
  double rms_s2s = 0, sd = 0;
};

// The position of the left eye's gaze minus that of the right eye, with right and up positive, in the unit of the
// report. The spread is the interquartile range / 1.349.
struct GazeDisparity {
  std::size_t pairs = 0;
  double horizontal = 0, vertical = 0;
  double horizontal_spread = 0, vertical_spread = 0;
  double vertical_correlation = 0, horizontal_correlation = 0;  // of the two eyes' positions
};

// Whether an axis points in the direction that was assumed.
enum class AxisVerdict : std::uint8_t { confirmed, flipped, undecided };
std::string_view to_string(AxisVerdict verdict);
struct GazeAxisTest {
  char axis = 'y';  // x or y
  AxisVerdict verdict = AxisVerdict::undecided;
  std::string evidence;
};

// The vestibulo-ocular reflex keeps gaze still in the world while the head turns, so the right sign of an axis is the
// one under which gaze is steadier in the world. The test looks at stretches of 250 ms in which the head turns by 5 to
// 150 deg/s about that axis and the eye makes no saccade. The verdict rests on the share of stretches that are steadier
// as read, by a sign test, and on the ratio of the speeds.
struct VorTest {
  char axis = 'x';
  std::size_t stretches = 0, steadier_as_read = 0;
  double speed_as_read_deg_s = 0, speed_flipped_deg_s = 0;  // medians of gaze in the world
  AxisVerdict verdict = AxisVerdict::undecided;
};

enum class FindingKind : std::uint8_t {
  fault,      // certain, because the file itself says so
  suspicion,  // concluded from statistics, and may be wrong
  note,       // worth knowing, but there is nothing to mend
};
std::string_view to_string(FindingKind kind);

struct GazeFinding {
  FindingKind kind = FindingKind::note;
  std::string
      code;  // "unordered", "repeated-rows", "time-unit", "position-unit", "origin", "zero-missing",
             // "missing-value", "decimal-commas", "y-flip", "x-flip", "swapped-axes", "frozen", "disparity", ...
  std::string what;
  std::string evidence;
  std::string setting;   // the repair, such as "`flip-y`" or "`unit` px"; empty: no option does
  bool is_open = false;  // a question that `setting` answers: until then only an inspection reads the file
};

struct GazeInspection {
  // The log's statements about itself, see GazeLog. Anything that identifies a person is left out unless the options
  // keep it.
  std::string source, format, clock, pupil_unit;
  double format_confidence = 1;
  GazeKind kind = GazeKind::screen;
  std::vector<GazeFact> facts;
  std::optional<DisplayGeometry> geometry;
  std::vector<GazeCalibration> calibrations;
  std::vector<GazeRecording> recordings;  // as GazeLog has them, and which of them was inspected
  std::size_t recording = 0;
  std::array<std::size_t, 7> events{};  // in the order of GazeEventType
  std::size_t head_poses = 0;
  bool both_eyes = false;
  bool is_wall_clock = false;  // stamps are times of day; unless the options keep them, first_ns and last_ns are 0
  Warnings warnings;

  GazeOrder order;
  GazeTiming timing;
  std::int64_t span_ns = 0;  // from the first sample to the last, also where these are not shown
  GazeLoss loss;
  GazeFrozen frozen;
  std::string unit;  // of precision and disparity: "deg", "px" or "of the picture"
  std::optional<GazePrecision> precision;
  std::optional<GazeDisparity> disparity;
  std::array<double, 2> range_x{}, range_y{};  // u and v, or direction x and y, of usable samples
  std::vector<VorTest> vor;
  std::vector<GazeAxisTest> axes;
  std::vector<GazeFinding> findings;
  std::string verdict;                // one sentence
  std::vector<std::string> settings;  // those that mend findings, in the order in which to give them
};

// Names, participants, serial numbers and times of day are left out unless `keep_ids` is set. `display` completes
// the log's display.
struct GazeInspectOptions {
  std::optional<DisplayGeometry> display;
  bool keep_ids = false;
};
// Findings from a log alone.
GazeInspection inspect_gaze(const GazeLog& log, const GazeInspectOptions& options);

// A log together with the raw numbers of its file, which an inspection can interpret again under other conventions.
struct GazeUnderInspection {
  RawGaze raw;
  Conventions conventions;
  bool is_first_of_several = false;  // no recording was chosen, and the first one is looked at
  bool is_sorted_by_option = false;  // if false, rows that are out of order or repeated are findings
  GazeLog log;
};
// Broken logs are mended where an option can mend them, and each fault becomes a finding. Of several recordings the
// first one is taken. Gaze on a scene camera's picture is accepted. Display sizes that nobody states are guessed, as
// `GazeReadOptions::guess_display` says.
GazeUnderInspection load_for_inspection(const std::string& path, GazeReadOptions read);
GazeInspection inspect_gaze(const GazeUnderInspection& gaze, const GazeInspectOptions& options);

std::string inspection_text(const GazeInspection& inspection);
std::string inspection_json(const GazeInspection& inspection);

}  // namespace gazetrace
