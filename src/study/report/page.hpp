// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/gaze_report.hpp"

namespace gazetrace {

// The page of a report whose other parts are there.
std::string gaze_page(const GazeLog& log, const GazeReport& report);
// Its numbers.
std::string gaze_report_json(const GazeLog& log, const GazeReport& report);
// How often a movement occurs, and the quantile of a measure of its events; NaN of none.
std::size_t count_of(const EyeEvents& events, EyeMovement movement);
std::vector<double> durations_ms(const GazeLog& log, const EyeEvents& events, EyeMovement movement);
std::vector<double> amplitudes_deg(const EyeEvents& events, EyeMovement movement);

}  // namespace gazetrace
