// SPDX-License-Identifier: Apache-2.0
// Rows of a log in the order of time, one for each eye at a time.
#pragma once

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Sorts the samples by time where that is the policy; Error(input) naming the first row that is out of order where it
// is not. `log.order` counts what was found.
void order_samples(GazeLog& log, UnorderedPolicy policy);
// Keeps the last row of each eye among rows of one time, under the same policy.
void drop_duplicates(GazeLog& log, UnorderedPolicy policy);
// The same as messages: what is wrong with the first row that is out of order, or that repeats a time.
std::string unordered_problem(const GazeOrder& order);
std::string duplicate_problem(const GazeOrder& order);

// Origins come in the order of the file, perhaps each eye's in a row of its own; samples have one each when this is
// done.
void align_origins(GazeLog& log);

}  // namespace gazetrace
