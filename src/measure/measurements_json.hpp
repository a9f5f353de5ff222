// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_measure.hpp"

namespace gazetrace {

// All numbers of the measurements, and what a drawing has to know of their tables.
std::string measurements_json(const GazeLog& log, const GazeMeasurements& measured);
std::vector<double> durations_ms(const GazeLog& log, const EyeEvents& events, EyeMovement movement);
std::vector<double> amplitudes_deg(const EyeEvents& events, EyeMovement movement);

}  // namespace gazetrace
