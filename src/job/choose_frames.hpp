// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// Those that the job names; else as many as the camera's path is long; without one, the gaze log; without one, the
// scene's animation. `decision` says which.
std::vector<std::int32_t> choose_frames(const JobSettings& job, const CameraPath& camera, const GazeLog* log,
                                        std::int64_t taken_off_ns, const Scene* scene, std::string& decision);
// Up to `count` frames before the first, as far apart as the first two; none before frame 1.
std::vector<std::int32_t> frames_before(const std::vector<std::int32_t>& frames, std::int32_t count);

}  // namespace gazetrace
