// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// The rows of a table of trials in the order of time, see TrialRules::table; numbers and blocks are not filled in.
std::vector<GazeTrial> read_trial_table(const std::string& path);

}  // namespace gazetrace
