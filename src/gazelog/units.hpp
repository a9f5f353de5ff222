// SPDX-License-Identifier: Apache-2.0
// Units and origins of logs, from the text of headers, from what the user declares and, as a last resort, from
// statistics.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

std::optional<PositionUnit> position_unit_from(std::string_view text);  // "px", "1", "norm", "ADCSpx", "deg", ...
std::string_view to_string(TimeUnit unit);
std::optional<int> time_exponent_of(TimeUnit unit);
std::string time_unit_text(int exponent);

// Guessed from the median step between raw stamps that differ; empty where the values fit no unit.
std::optional<int> guess_time_exponent(const std::vector<double>& raw_times);

}  // namespace gazetrace
