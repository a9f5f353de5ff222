// SPDX-License-Identifier: Apache-2.0
// One exposure for all frames of a sequence, found before the first of them.
#pragma once

#include "gazetrace/resolve.hpp"
#include "job/choose_frames.hpp"

namespace gazetrace {

// The frames of settle_exposure(): at most eight, spread over the sequence as it is without `frames`; one where nothing
// moves. Empty for a fixed exposure. `plan` are the settings of the job's own plan.
FramePlan plan_exposure_probe(const JobSettings& job, const ViewInputs& inputs, PlanSettings plan);

}  // namespace gazetrace
