// SPDX-License-Identifier: Apache-2.0
// How tables write a number, and one that is not known.
#pragma once

#include <cmath>
#include <string>

namespace gazetrace {

std::string number_cell(double value);

template <class Json>
Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace gazetrace
