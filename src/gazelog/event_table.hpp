// SPDX-License-Identifier: Apache-2.0
// Tables that trackers and analysis programs write beside gaze: fixations, saccades and blinks with one row for each,
// corners of surfaces, movements of the head. Their columns of time and place look like gaze.
#pragma once

#include <string>
#include <vector>

#include "gazelog/gaze_format.hpp"

namespace gazetrace {

// Throws Error(input) for a table that holds no gaze, saying what it holds and what it is good for. `is_named`: the
// user names the format, so that only what is certain is refused.
void refuse_other_tables(const GazeFile& file, bool is_named);

// The events of a table with one row for each. Throws Error(input) for a file that is no such table.
std::vector<GazeEvent> read_event_table(const std::string& path);

// Makes the events of the table at `path` events of the log. Those of the same types that the log states itself give
// way to them, with a warning; those that do not touch the log's time are left out, with a warning.
void take_events(const std::string& path, RawGaze& raw);

}  // namespace gazetrace
