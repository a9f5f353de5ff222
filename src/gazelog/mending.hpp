// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Whether decimal commas that split the cells of a table are joined again though nobody said that they are there. What
// was mended is one of `RawGaze::faults`.
enum class Mending { none, decimal_commas };
RawGaze read_raw_gaze(const std::string& path, const GazeReadOptions& options, Mending mending);

}  // namespace gazetrace
