// SPDX-License-Identifier: Apache-2.0
// Asking a gaze log where the eye was at a time, and how the log's clock runs against the video's. gaze_read.hpp reads
// logs, gaze_log.hpp says what they are.
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
