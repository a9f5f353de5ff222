// SPDX-License-Identifier: Apache-2.0
// Gaze logs: reading them (gaze_log.hpp says what they are then), and asking one where the eye was at a time.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

enum class TimeUnit { automatic, ns, us, ms, s };
enum class PositionUnit { automatic, fraction, px, mm, cm, deg, unit_vector };
// Where (0, 0) is and which way y grows: down from the top, up from the bottom and the center. Fractions from the
// center count half the display, -1..1. automatic: the center for degrees, else top left.
enum class PositionOrigin { automatic, top_left, bottom_left, center };

// Axes in which a log writes directions and origins, and a head's pose. All have +y up but `cv`.
//   gl        +x right, -z forward, right-handed: OpenXR, glTF, and gazetrace itself
//   unity     +x right, +z forward, left-handed
//   sranipal  +x to the wearer's left, +z forward, right-handed: HTC's SDK, Tobii's glasses
//   cv        +x right, +y down, +z forward, right-handed: scene cameras
enum class GazeAxes { automatic, gl, unity, sranipal, cv };

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

enum class UnorderedPolicy { error, sort };

// Which gaze a binocular log gives.
//   automatic  the log's own combined gaze where it has one; else the mean, or, where the eyes differ vertically by
//              over 0.5 deg in the median, the best eye, with a warning. A combined gaze may jump when an eye is lost
//   left, right  that eye alone
//   mean       of both eyes, in angle. While one eye is lost the other stands in, moved by half the offset between
//              them: for up to 75 ms straight from the one before to the one after, else the running one
//   dominant   `dominant_eye`; while it is lost the other, moved by the offset
//   best       as dominant, with the eye that has more usable samples, or less noise where both have as many
enum class EyeChoice { automatic, left, right, mean, dominant, best };

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
  // As guess_display; moreover what reading refuses and an option mends is mended and told in GazeLog::faults, and gaze
  // on a scene camera's picture is taken.
  bool for_inspection = false;
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
// Lossless, bit by bit, for samples, both eyes and origins, but `row`: header `t[ns],u[1],v[1],valid,eye,...` or
// `t[ns],dx,dy,dz,...`. With both eyes there are three rows a time; where the gaze is one eye's everywhere, that eye's
// rows are not written twice and `# eye` names it. The head's pose stands in the first row of a time; poses between
// samples, events, messages and calibrations stand in lines before the header.
void write_gaze_csv(const GazeLog& log, const std::string& path);

// The same as BIDS eye tracking: one file for each eye, and one for what was made of both, with sidecars, the log's
// events and the screen, but no head poses. `path` names it: sub-01_task-view_physio.tsv.gz; a recording- in it is
// replaced by eye1, eye2 and cyclopean. Lossless as above. Error(usage) for another name, Error(input) for gaze on a
// scene camera's picture.
void write_gaze_bids(const GazeLog& log, const std::string& path);
std::vector<std::string> bids_file_names(const GazeLog& log, const std::string& path);  // what it would write
bool is_bids_file_name(const std::string& path);

// hold: the last row at or before the time. nearest: the row closest in time. linear: between two neighbouring usable
// rows no farther apart than `max_interpolation_gap_ns`, so never across blinks and lost rows; where it is known what
// the eye does, also only within a fixation, else the nearer row. Where nearest or linear find no usable row they hold.
enum class GazeInterpolation { hold, nearest, linear };
// What a frame without usable gaze does. hold: takes the last usable row however old; before the first one the
// center, as a gaze that is yet to come steers nothing.
enum class NoGazePolicy { hold, center, uniform, error };

// t_video = scale * (t_log - t_event) + offset.
struct GazeMapping {
  GazeInterpolation interpolation = GazeInterpolation::hold;
  NoGazePolicy no_gaze = NoGazePolicy::hold;
  std::int64_t max_age_ns = 500'000'000;  // an older sample counts as no gaze
  // linear across no more than this; a row older than this is `held` (Tobii I-VT gap fill).
  std::int64_t max_interpolation_gap_ns = 75'000'000;
  double scale = 1.0;
  std::int64_t offset_ns = 0;
  std::optional<std::int64_t> event_ns;  // log time that is video time `offset_ns`; default: the first sample's
};

enum class GazeState : std::uint8_t {
  measured,  // one row or two rows of the log at this time
  held,      // an older row, because the log has a gap here
  center,    // no gaze; the view's centre by policy
  none,      // no gaze; the frame is rendered uniformly by policy
};
std::string_view to_string(GazeState state);

inline constexpr std::int64_t kSaccadeMemoryNs = 1'000'000'000;

struct GazeAtTime {
  GazeKind kind = GazeKind::screen;  // u, v or direction
  GazeState state = GazeState::none;
  double u = 0.5, v = 0.5;
  Vec3d direction{0, 0, -1};
  std::int64_t t_log_ns = 0;                   // the time asked for, on the log's clock
  std::int64_t row_before = 0, row_after = 0;  // 1-based source lines used; 0: none
  std::int64_t age_ns = 0;                     // time asked for minus time of the row (hold, nearest) or of row_before
  bool age_is_known = true;                    // not of a frame log, which repeats values (GazeLog::sample_age_unknown)
  bool no_gaze = false;                        // the log has none at this time; NoGazePolicy decided
  GazeValidity validity = GazeValidity::lost;  // of the row used; lost where none was
  std::optional<EyeMovement> movement;         // of the eye at the time asked for; empty: not known
  // On the log's clock since the eye was last seen in a saccade, 0 in one; empty: not within kSaccadeMemoryNs, or not
  // known. Saccades are shorter than most frames last: the movements of the frames alone would miss them.
  std::optional<std::int64_t> since_saccade_ns;
  std::string reason;  // for the plan: "hold: row 118", "gap of 312 ms: held row 104"
};

// Time on the log's clock of a video time, t_event + (t_video - offset) / scale, to the nearest nanosecond in 128-bit
// integers. Error(usage) for a scale that is not positive, or a time beyond int64.
std::int64_t log_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns);
// The other way: scale (t_log - t_event) + offset, to the nearest nanosecond, under the same errors.
std::int64_t video_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_log_ns);
// Error(input) under NoGazePolicy::error, naming the time and the nearest rows.
// `movements`: what the eye does at each sample (EyeEvents::labels), or nothing.
GazeAtTime gaze_at(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns,
                   const std::vector<EyeMovement>* movements = nullptr);

// One event of two clocks.
struct ClockAnchor {
  std::int64_t t_log_ns = 0, t_video_ns = 0;
};
// scale, offset and event of a GazeMapping by least squares over the anchors, and what they leave over. One anchor
// gives the offset and a scale of 1. Error(usage) for anchors at one time of the log only, or a scale that is not
// positive.
struct ClockFit {
  double scale = 1;
  std::int64_t offset_ns = 0, event_ns = 0;
  double rms_residual_ns = 0, max_residual_ns = 0;
};
ClockFit fit_clock(const std::vector<ClockAnchor>& anchors);
// The time of the one message or event of the log whose text is `text` or, where none is, contains it. Error(input)
// where it is not there, or there more than once.
std::int64_t time_of_message(const GazeLog& log, std::string_view text);

}  // namespace gazetrace
