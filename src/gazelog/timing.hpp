// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// A step between neighbouring samples that is longer than this many median steps is a gap.
inline constexpr double kGapInSteps = 3;

// The samples with which a section begins that was recorded without a pause: the first one, and those that are the
// first at or after the begin of a segment of the recording. Increasing; of a log with at least one sample.
std::vector<std::size_t> section_starts(const GazeLog& log);

// The timing of a log with at least one sample.
GazeTiming measure_timing(const GazeLog& log);

}  // namespace gazetrace
