// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gazetrace/report.hpp"

namespace gazetrace {

std::string csv_cell(const std::string& text);                   // quoted where it must be
std::string csv_number(const std::optional<double>& value);      // empty for what is missing
std::string csv_estimate(const std::optional<Estimate>& value);  // mean, low, high

}  // namespace gazetrace
