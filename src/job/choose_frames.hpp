// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// The frames that the job names; otherwise as many as the camera's path lasts or, without one, the gaze log or, without
// one, the scene's animation. `decision` receives in words which of these it was.
std::vector<std::int32_t> choose_frames(const JobSettings& job, const CameraPath& camera, const GazeLog* log,
                                        std::int64_t taken_off_ns, const Scene* scene, std::string& decision);
// Whether that can depend on the scene's animation.
bool may_follow_scene(const JobSettings& job, const CameraPath& camera, const GazeLog* log);

}  // namespace gazetrace
