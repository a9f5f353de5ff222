// SPDX-License-Identifier: Apache-2.0
// Gaze logs: reading them, and asking one where the eye was at a time.
//
// Time is int64 nanoseconds on the log's own clock, never a float. Screen gaze is a fraction of the *display*:
// (0, 0) its top left edge, (1, 1) its bottom right, values outside lie beside it. Directions are unit vectors in the
// view frame: right-handed, +x right, +y up, -z forward.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

enum class GazeKind : std::uint8_t { screen, direction };
enum class GazeValidity : std::uint8_t { ok, low_confidence, blink, lost, off_screen, interpolated };
enum class Eye : std::uint8_t { left, right, cyclopean };

std::string_view to_string(GazeValidity validity);
std::string_view to_string(Eye eye);

struct GazeSample {
  std::int64_t t_ns = 0;
  double u = 0, v = 0;        // GazeKind::screen
  Vec3d direction{0, 0, -1};  // GazeKind::direction
  GazeValidity validity = GazeValidity::ok;
  Eye eye = Eye::cyclopean;
  float confidence = 1.0F;  // 0..1, NaN where the log has none
  float pupil = 0.0F;       // in the log's own unit, NaN where missing
  std::int64_t row = 0;     // 1-based line in the source file
  // Coordinates are NaN where the log has none; such samples are never usable.
};

// off_screen samples are good measurements that happen to lie beside the display.
inline bool is_usable(GazeValidity v) {
  return v == GazeValidity::ok || v == GazeValidity::off_screen || v == GazeValidity::interpolated;
}

struct GazeLog {
  GazeKind kind = GazeKind::screen;
  // Times increase. Rows of several eyes at one time are one cyclopean sample: the log's own where it has one, else the
  // mean of the usable eyes.
  std::vector<GazeSample> samples;
  std::string source;  // the path as given
  std::string format;  // a name of `gaze_formats()`
  std::string clock;   // what the log says of its clock; may be empty
  // Geometry of the recording where the log states it (any zero field: not stated).
  std::optional<DisplayGeometry> recording_geometry;
  Warnings warnings;
};

enum class TimeUnit { automatic, ns, us, ms, s };
enum class PositionUnit { automatic, fraction, px, mm, cm, deg, unit_vector };
// Where (0, 0) is and which way y grows: down from the top, up from the bottom and the center. Fractions from the
// center count half the display, -1..1. automatic: the center for degrees, else top left.
enum class PositionOrigin { automatic, top_left, bottom_left, center };

// What the user declared about columns of a CSV/TSV that does not say it itself. Empty names: found by header.
struct GazeColumns {
  std::string time, x, y, z, validity, confidence, pupil, eye;
  TimeUnit time_unit = TimeUnit::automatic;
  PositionUnit position_unit = PositionUnit::automatic;
  PositionOrigin origin = PositionOrigin::automatic;
  // "ok" values of the validity column; empty: 1, true, ok, valid (any case).
  std::vector<std::string> valid_values;
};

enum class UnorderedPolicy { error, sort };

struct GazeReadOptions {
  std::string format;  // a name of `gaze_formats()`; empty: by sniffing
  GazeColumns columns;
  // Converts px, mm and degrees to fractions; needed only for those.
  std::optional<DisplayGeometry> display;
  UnorderedPolicy unordered = UnorderedPolicy::error;
};

struct GazeFormatInfo {
  std::string name;
  std::string description;
};
std::vector<GazeFormatInfo> gaze_formats();

// Error(input) with file:line for a log without time, without samples, with unordered or duplicated stamps (unless
// sorting was asked for; then the last of equal stamps is kept and a warning counts them), with unknown columns or
// units.
GazeLog load_gaze_log(const std::string& path, const GazeReadOptions& options);
// Lossless, bit by bit, for all fields but `row`: header `t[ns],u[1],v[1],valid,eye,...` or `t[ns],dx,dy,dz,...`.
void write_gaze_csv(const GazeLog& log, const std::string& path);

// hold: the last row at or before the time. nearest: the row closest in time. linear: between two neighbouring usable
// rows no farther apart than `max_interpolation_gap_ns`, so never across blinks and lost rows. Where nearest or linear
// find no usable row they hold.
enum class GazeInterpolation { hold, nearest, linear };
// What a frame without usable gaze does. hold: takes the last usable row however old, before the first one the first.
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

struct GazeAtTime {
  GazeKind kind = GazeKind::screen;  // u, v or direction
  GazeState state = GazeState::none;
  double u = 0.5, v = 0.5;
  Vec3d direction{0, 0, -1};
  std::int64_t t_log_ns = 0;                   // the time asked for, on the log's clock
  std::int64_t row_before = 0, row_after = 0;  // 1-based source lines used; 0: none
  std::int64_t age_ns = 0;                     // time asked for minus time of the row (hold, nearest) or of row_before
  std::string reason;                          // for the plan: "hold: row 118", "gap of 312 ms: held row 104"
};

// Time on the log's clock of a video time, t_event + (t_video - offset) / scale, to the nearest nanosecond in 128-bit
// integers. Error(usage) for a scale that is not positive, or a time beyond int64.
std::int64_t log_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns);
// Error(input) under NoGazePolicy::error, naming the time and the nearest rows.
GazeAtTime gaze_at(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns);

}  // namespace gazetrace
