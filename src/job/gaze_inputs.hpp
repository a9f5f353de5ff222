// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// The log that the job names, or its fixed gaze as a log of one sample; empty: no gaze. Times of day are hidden unless
// the job keeps them; `taken_off_ns` then says what was taken off the stamps.
std::optional<GazeLog> gaze_of_job(const JobSettings& job, std::int64_t& taken_off_ns);
// Empty: the job does not ask for it. Error(usage, input) where neither job nor log tell what is needed.
std::optional<GazeUncertainty> gaze_uncertainty(const JobSettings& job, const GazeLog& log);

}  // namespace gazetrace
