// SPDX-License-Identifier: Apache-2.0
// What the eye does at the time of a frame, how fast it goes, and how old a frame's gaze is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/gaze_events.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

// Of one log. Without angles nothing is known.
class GazeMotion {
 public:
  GazeMotion(const GazeLog* log, const PlanSettings& settings);

  // One for each sample, or nothing.
  [[nodiscard]] const std::vector<EyeMovement>* movements() const { return movements_.empty() ? nullptr : &movements_; }
  // accuracy + precision + age x speed of the gaze that steers the frame; 0 where not asked for or without gaze.
  [[nodiscard]] double uncertainty_deg(const FrameRequest& request) const;
  // At a time on the log's clock: how fast the gaze goes (0 where nobody asked or nothing is known), and whether the
  // eye is in a saccade.
  [[nodiscard]] double speed_deg_s(std::int64_t t_log_ns) const;
  [[nodiscard]] bool in_saccade(std::int64_t t_log_ns) const;
  // Whether the eye did this at any time after the first and up to the second.
  [[nodiscard]] bool did(EyeMovement movement, std::int64_t after_log_ns, std::int64_t t_log_ns) const;

 private:
  // The last sample that is not after the time; the first, where all are.
  [[nodiscard]] std::size_t row_at(std::int64_t t_log_ns) const;

  const GazeLog* log_;
  std::optional<GazeUncertainty> uncertainty_;
  std::vector<EyeMovement> movements_;
  std::vector<double> speed_deg_s_;
};

// The age in log time of what steers the frame, from the middle of the frame: of interpolated gaze, of the time that it
// was interpolated for. Empty without rows.
std::optional<std::int64_t> effective_age_ns(const FrameRequest& request);

std::optional<GazeAges> gaze_ages(const FramePlan& plan, const PlanSettings& settings);
// A frame shows one gaze for its whole time: below 4 frames the age of a latency is not a number but a range.
void warn_about_latency(const PlanSettings& settings, Warnings& warnings);

}  // namespace gazetrace
