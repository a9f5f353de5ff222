// SPDX-License-Identifier: Apache-2.0
// "Not known", as a number: what a table or a picture holds where nothing was measured.
#pragma once

#include <cmath>
#include <limits>

namespace gazetrace {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Whether two numbers are the same, or are both not known.
inline bool same_or_unknown(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

}  // namespace gazetrace
