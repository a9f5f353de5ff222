// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// Throws Error(usage, input) where the job names no camera, or two. `decision` receives in words which camera it is.
CameraPath choose_camera(const JobSettings& job, const Scene* scene, const GazeLog* log, std::int64_t taken_off_ns,
                         std::string& decision);

}  // namespace gazetrace
