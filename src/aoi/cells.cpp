// SPDX-License-Identifier: Apache-2.0
#include "aoi/cells.hpp"

#include <fmt/format.h>

namespace gazetrace {

std::string number_cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "n/a";
}

}  // namespace gazetrace
