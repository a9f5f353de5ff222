// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

// The frames that the job names; otherwise as many as the camera's path lasts or, without one, the gaze log or, without
// one, the scene's animation. `decision` receives in words which of these it was. Error(usage) for more than a plan
// holds.
std::vector<std::int32_t> choose_frames(const JobSettings& job, const ViewInputs& inputs, std::string& decision);
// Those of the whole sequence, whichever of them the job names.
std::vector<std::int32_t> frames_of_sequence(JobSettings job, const ViewInputs& inputs);
// Whether they can depend on the scene's animation; `is_whole`: those of the whole sequence.
bool may_follow_scene(const JobSettings& job, const CameraPath& camera, const GazeLog* log, bool is_whole);

}  // namespace gazetrace
