// SPDX-License-Identifier: Apache-2.0
// What tasks have left in folders of their own becomes that of one folder.
#pragma once

#include <string>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// Error(input) for a folder that no task of a sweep has worked in, or one of another build.
void check_chunks_in(const SweepPlan& plan, const std::string& folder);

// Runs, pictures and finished references of a task's folder that are not in the directory yet. Nothing there is
// replaced, and files are there completely or not at all. Error(input) for a folder without a task's work, or of
// another build.
void take_in(const std::string& folder, const std::string& directory);

}  // namespace gazetrace
