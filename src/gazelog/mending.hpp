// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Whether numbers that decimal commas split into two cells are joined again even where nobody declared decimal commas.
// Each mending is reported in `RawGaze::faults`.
enum class Mending { none, decimal_commas };
RawGaze read_raw_gaze(const std::string& path, const GazeReadOptions& options, Mending mending);

}  // namespace gazetrace
