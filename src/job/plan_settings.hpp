// SPDX-License-Identifier: Apache-2.0
// What a job and its gaze log say of a plan: when frames are, how gaze is carried to them, and where they are watched.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// Without a log (nullptr) there is no gaze. `taken_off_ns` is how many nanoseconds the log's stamps are below those of
// its file. `decisions` receive what was chosen of clock and screen.
PlanSettings plan_settings(const JobSettings& job, const std::vector<std::int32_t>& frames, const GazeLog* log,
                           std::int64_t taken_off_ns, Decisions& decisions);

// Throws Error(input, usage) where gaze on a screen has no screen, or where the screen cannot be one.
void check_screen(const PlanSettings& settings, const GazeLog* log);

}  // namespace gazetrace
