// SPDX-License-Identifier: Apache-2.0
// Plans the frames by which a stated quality (QualityTarget::jod) is judged before a sequence is rendered.
#pragma once

#include <cstdint>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// What the views of a sequence follow from. Scene and log may be missing.
struct ViewInputs {
  const CameraPath& camera;
  const GazeLog* log = nullptr;
  std::int64_t taken_off_ns = 0;  // of the log's times
  const Scene* scene = nullptr;
  const ProcessedGaze* steering = nullptr;  // the log as it steers, where it was processed
};

// The sequence is as long as the job is without `frames`, so that all its parts judge the same; where nothing moves, it
// is a still or, if there are `frames`, a second of rest. `plan` are the settings of the job's own plan. Error(usage)
// where the quality cannot be judged.
JudgedFrames plan_judged_frames(const JobSettings& job, const ViewInputs& inputs, PlanSettings plan,
                                Decisions& decisions);

}  // namespace gazetrace
