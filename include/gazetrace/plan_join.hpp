// SPDX-License-Identifier: Apache-2.0
// A plan that goes on where another run ended.
#pragma once

#include <cstdint>

#include "gazetrace/plan.hpp"

namespace gazetrace {

// What the eye has done since the frame before the plan's first, which is `frame_before` of the other run: by itself
// plan_frames() takes it to be as far away as the next one. `log` and `settings` are those that the plan was made of.
void join_plan(FramePlan& plan, std::int32_t frame_before, const GazeLog& log, const PlanSettings& settings);

}  // namespace gazetrace
