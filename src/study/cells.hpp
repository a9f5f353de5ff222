// SPDX-License-Identifier: Apache-2.0
// How the tables of a study write a number, and one that is not known.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include <fmt/format.h>

namespace gazetrace {

inline std::string number_cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "n/a";
}

inline nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace gazetrace
