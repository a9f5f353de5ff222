// SPDX-License-Identifier: Apache-2.0
// Facts that later stages ask for by name. A log that was converted states what its source told by its format.
#pragma once

#include <string_view>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

inline constexpr const char* kStatedEye = "chosen eye";  // "left" or "right": whose gaze stands for both
inline constexpr const char* kDevice = "device";         // "desktop" or "head-mounted"

// Of the last fact of that name; empty where there is none.
inline std::string_view fact_value(const GazeLog& log, std::string_view what) {
  for (auto fact = log.facts.rbegin(); fact != log.facts.rend(); ++fact) {
    if (fact->what == what) {
      return fact->value;
    }
  }
  return {};
}

}  // namespace gazetrace
