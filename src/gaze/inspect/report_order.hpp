// SPDX-License-Identifier: Apache-2.0
// The order in which a report tells of validities and kinds of events.
#pragma once

#include <array>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

inline constexpr std::array kReportedValidities{GazeValidity::ok,         GazeValidity::low_confidence,
                                                GazeValidity::blink,      GazeValidity::lost,
                                                GazeValidity::off_screen, GazeValidity::interpolated};
inline constexpr std::array kReportedEvents{GazeEventType::fixation, GazeEventType::saccade, GazeEventType::blink,
                                            GazeEventType::message,  GazeEventType::segment, GazeEventType::trial,
                                            GazeEventType::aoi};

}  // namespace gazetrace
