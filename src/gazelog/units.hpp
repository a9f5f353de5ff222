// SPDX-License-Identifier: Apache-2.0
// Units and origins of logs, from the text of headers, from what the user declares and, as a last resort, from
// statistics.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

std::optional<PositionUnit> position_unit_from(std::string_view text);  // "px", "1", "norm", "ADCSpx", "deg", ...
std::optional<int> time_exponent_of(TimeUnit unit);
std::string time_unit_text(int exponent);

// Guessed from the median step between raw stamps that differ; empty where the values fit no unit.
std::optional<int> guess_time_exponent(const std::vector<double>& raw_times);

// Statistics of usable rows, with x and y in one unit.
struct PositionStatistics {
  struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
  };
  Range x, y;
  double share_normalized = 0;  // both coordinates in [-0.2, 1.2]
  double share_small = 0;       // both below 90 in magnitude
  double share_negative = 0;    // either coordinate below 0
  std::size_t count = 0;
};
PositionStatistics measure_positions(const RawRows& samples);

// Guessed from the values of usable rows; `evidence` receives what was seen.
PositionUnit guess_position_unit(const RawRows& samples, std::string& evidence);

}  // namespace gazetrace
