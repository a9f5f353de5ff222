// SPDX-License-Identifier: Apache-2.0
// Plans the frames by which a stated quality (QualityTarget::jod) is judged before a sequence is rendered.
#pragma once

#include <cstdint>

#include "job/choose_frames.hpp"

namespace gazetrace {

// The sequence is as long as the job is without `frames`, so that all its parts judge the same; where nothing moves, it
// is a still or, if there are `frames`, a second of rest. `plan` are the settings of the job's own plan. Error(usage)
// where the quality cannot be judged.
JudgedFrames plan_judged_frames(const JobSettings& job, const ViewInputs& inputs, PlanSettings plan,
                                Decisions& decisions);

}  // namespace gazetrace
