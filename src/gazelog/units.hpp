// SPDX-License-Identifier: Apache-2.0
// Units and origins of logs: from header text, from what the user declares, and last from statistics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

std::optional<PositionUnit> position_unit_from(std::string_view text);  // "px", "1", "norm", "ADCSpx", "deg", ...
std::string_view to_string(PositionUnit unit);
std::string_view to_string(PositionOrigin origin);
std::optional<int> time_exponent_of(TimeUnit unit);
std::string time_unit_text(int exponent);

// From the median step between raw stamps that differ; empty where the values fit no unit. Always a guess.
std::optional<int> guess_time_exponent(const std::vector<double>& raw_times);

// From the values of usable samples; `evidence` says what was seen. Always a guess.
PositionUnit guess_position_unit(const std::vector<GazeSample>& samples, std::string& evidence);

// Whether 90 % of the raw positions can be of the unit that was stated: degrees, or lengths on a display that is known.
// Empty: they can. `origin` is where other units would count from.
std::optional<GazeFault> doubt_position_unit(const std::vector<GazeSample>& samples, PositionUnit stated,
                                             PositionOrigin origin, const DisplayGeometry& display);

// Raw positions to fractions of the display, in place. Error(input) at `place` where a unit needs a display that is not
// known well enough. Also warns of values that look like another origin.
void convert_positions(GazeLog& log, PositionUnit unit, PositionOrigin origin,
                       const std::optional<DisplayGeometry>& display, const std::string& place);

}  // namespace gazetrace
