// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// A step between neighbouring samples that is longer than this many median steps is a gap.
inline constexpr double kGapInSteps = 3;

// The timing of a log with at least one sample.
GazeTiming measure_timing(const GazeLog& log);

}  // namespace gazetrace
