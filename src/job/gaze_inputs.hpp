// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// The log that the job names, or its fixed gaze as a log of one sample; empty where there is no gaze. Times of day are
// hidden unless the job keeps them; `taken_off_ns` then receives what was subtracted from the stamps.
std::optional<GazeLog> gaze_of_job(const JobSettings& job, std::int64_t& taken_off_ns);

}  // namespace gazetrace
