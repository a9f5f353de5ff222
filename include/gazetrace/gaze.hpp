// SPDX-License-Identifier: Apache-2.0
// Asking a gaze log where the eye was at a given time, and how the log's clock runs against the video's. gaze_read.hpp
// reads logs, and gaze_log.hpp describes a log.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// hold: the last row at or before the time is taken. nearest: the row closest in time is taken. linear: gaze is
// interpolated between two neighbouring usable rows that are no farther apart than `max_interpolation_gap_ns`, so never
// across blinks and lost rows. Where the movements of the eye are known, linear also interpolates only within a
// fixation and takes the nearer row elsewhere. Where nearest or linear find no usable row, they hold the last one.
enum class GazeInterpolation { hold, nearest, linear };
// The gaze of a frame without usable gaze. hold: it takes the last usable row, however old that is. Before the first
// usable row it takes the center, because gaze that is yet to come must not steer a frame.
enum class NoGazePolicy { hold, center, uniform, error };

// t_video = scale * (t_log - t_event) + offset.
struct GazeMapping {
  GazeInterpolation interpolation = GazeInterpolation::hold;
  NoGazePolicy no_gaze = NoGazePolicy::hold;
  std::int64_t max_age_ns = 500'000'000;  // an older sample counts as no gaze
  // linear interpolates across gaps up to this length; a row older than this is `held` (as in the gap fill of Tobii
  // I-VT).
  std::int64_t max_interpolation_gap_ns = 75'000'000;
  double scale = 1.0;
  std::int64_t offset_ns = 0;
  std::optional<std::int64_t> event_ns;  // the log time that is video time `offset_ns`; empty: the first sample's
};

enum class GazeState : std::uint8_t {
  measured,  // taken from one row or two rows of the log at this time
  held,      // taken from an older row, because the log has a gap here
  center,    // there is no gaze; the policy takes the view's centre
  none,      // there is no gaze; by the policy the frame is rendered uniformly
};
std::string_view to_string(GazeState state);

inline constexpr std::int64_t kSaccadeMemoryNs = 1'000'000'000;

struct GazeAtTime {
  GazeKind kind = GazeKind::screen;  // says whether u, v or direction count
  GazeState state = GazeState::none;
  double u = 0.5, v = 0.5;
  Vec3d direction{0, 0, -1};
  std::int64_t t_log_ns = 0;                   // the time asked for, on the log's clock
  std::int64_t row_before = 0, row_after = 0;  // 1-based source lines used; 0: none
  std::int64_t age_ns = 0;                     // time asked for minus time of the row (hold, nearest) or of row_before
  bool age_is_known = true;                    // false for a frame log, see GazeLog::sample_age_unknown
  bool no_gaze = false;                        // the log has no gaze at this time, and NoGazePolicy decided
  GazeValidity validity = GazeValidity::lost;  // of the row used; lost where none was
  std::optional<EyeMovement> movement;         // of the eye at the time asked for; empty: not known
  // Time on the log's clock since the eye was last seen in a saccade; 0 within a saccade; empty where there was none
  // within kSaccadeMemoryNs or the movements are not known. Most saccades are shorter than a frame, so that looking
  // only at the movement at each frame's time would miss them.
  std::optional<std::int64_t> since_saccade_ns;
  std::string reason;  // for the plan: "hold: row 118", "gap of 312 ms: held row 104"
};

// The time on the log's clock that belongs to a video time: t_event + (t_video - offset) / scale, rounded to the
// nearest nanosecond in 128-bit integers. Throws Error(usage) for a scale that is not positive and for a time beyond
// int64.
std::int64_t log_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns);
// The other way: scale (t_log - t_event) + offset, to the nearest nanosecond, under the same errors.
std::int64_t video_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_log_ns);
// Where there is no gaze and the policy is NoGazePolicy::error, throws Error(input) that names the time and the nearest
// rows. `movements` is the eye's movement at each sample (EyeEvents::labels); null where it is unknown.
GazeAtTime gaze_at(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns,
                   const std::vector<EyeMovement>* movements = nullptr);

// One event as two clocks saw it.
struct ClockAnchor {
  std::int64_t t_log_ns = 0, t_video_ns = 0;
};
// Scale, offset and event of a GazeMapping, fitted to the anchors by least squares, and the residuals of the fit. A
// single anchor gives the offset and a scale of 1. Throws Error(usage) when all anchors stand at one time of the log,
// or when the scale is not positive.
struct ClockFit {
  double scale = 1;
  std::int64_t offset_ns = 0, event_ns = 0;
  double rms_residual_ns = 0, max_residual_ns = 0;
};
ClockFit fit_clock(const std::vector<ClockAnchor>& anchors);
// The time of the one message or event of the log whose text is `text` or else contains it; "text#2" is the second of
// several. Throws Error(input) where it is not in the log or, without such a number, is in it more than once.
std::int64_t time_of_message(const GazeLog& log, std::string_view text);

}  // namespace gazetrace
