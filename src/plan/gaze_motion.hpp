// SPDX-License-Identifier: Apache-2.0
// What the eye does at the time of a frame, and how old a frame's gaze is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/gaze_events.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

// The movements of the eye in one log. Where the log has no angles, nothing is known.
class GazeMotion {
 public:
  GazeMotion(const GazeLog* log, const PlanSettings& settings);

  // One for each sample of the log; nullptr where nothing is known.
  [[nodiscard]] const std::vector<EyeMovement>* movements() const { return movements_.empty() ? nullptr : &movements_; }
  // Whether the eye is seen in a saccade at a time on the log's clock. Before the log, in its gaps and after its end
  // nothing is known.
  [[nodiscard]] bool in_saccade(std::int64_t t_log_ns) const;
  // Whether the eye made this movement at any time after the first time and up to the second.
  [[nodiscard]] bool did(EyeMovement movement, std::int64_t after_log_ns, std::int64_t t_log_ns) const;

 private:
  // The last sample that is not after the time; where all are after it, the first.
  [[nodiscard]] std::size_t row_at(std::int64_t t_log_ns) const;
  [[nodiscard]] bool is_seen(std::int64_t t_log_ns) const;

  const GazeLog* log_;
  std::int64_t max_gap_ns_;
  std::vector<EyeMovement> movements_;
};

// The age, in log time and at the middle of the frame, of the gaze that steers it. Interpolated gaze is as old as the
// time that it was interpolated for. Empty where the gaze does not come from rows of a log.
std::optional<std::int64_t> effective_age_ns(const FrameRequest& request);

std::optional<GazeAges> gaze_ages(const FramePlan& plan, const PlanSettings& settings);
// Warns of latencies below 4 frames: since a frame shows one gaze for its whole time, such a latency is more of a range
// than a number.
void warn_about_latency(const PlanSettings& settings, Warnings& warnings);

}  // namespace gazetrace
