// SPDX-License-Identifier: Apache-2.0
// What a job takes where nobody says it, as far as that depends on what else is said, or on its inputs.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/job.hpp"
#include "job/choose_frames.hpp"

namespace gazetrace {

// The sampling where neither options nor a preset name one: adaptive for a stated quality, regions for what is stated
// of them, else the density of JobSettings. The choice is added to `decisions`, if there are any.
Job with_default_sampling(Job job, Decisions* decisions = nullptr);

// The rate of a density about the gaze: two samples a pixel on average. The frame's mean is given and not the rate
// where the eye looks, since how many times larger that is follows from the screen's pixels a degree. `log`: nullptr
// without gaze, and nothing changes.
void settle_rate(const GazeLog* log, JobSettings& job);

// AccumulateMode::automatic becomes a window for a sequence, and off for a single still, for a stated quality and for
// raw samples (the filter none). `frames` are those that the job wants; one of them alone joins as it does in the whole
// sequence, so that it is the same picture. Where the job does not state how long its window is, it has 16 million
// pixels at most, but one frame on each side, which takes 4 to 6 GB on any machine.
void settle_accumulation(const ViewInputs& inputs, const std::vector<std::int32_t>& frames, Job& job,
                         Decisions& decisions);

}  // namespace gazetrace
