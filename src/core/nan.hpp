// SPDX-License-Identifier: Apache-2.0
// "Not known", as a number: what a table or a picture holds where nothing was measured.
#pragma once

#include <limits>

namespace gazetrace {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace gazetrace
