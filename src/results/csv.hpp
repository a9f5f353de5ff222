// SPDX-License-Identifier: Apache-2.0
// Cells of comma-separated tables.
#pragma once

#include <optional>
#include <string>

#include "gazetrace/results.hpp"

namespace gazetrace {

std::string csv_cell(const std::string& text);  // quoted where it must be
// Blank where it is missing.
std::string csv_number(const std::optional<double>& value);
std::string csv_interval(const std::optional<Interval>& value);  // mean, low and high: three cells

}  // namespace gazetrace
