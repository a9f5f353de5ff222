// SPDX-License-Identifier: Apache-2.0
// Puts the rows of a log in the order of time, with at most one for each eye at each time.
#pragma once

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Sorts the samples by time where that is the policy; otherwise throws Error(input) naming the first row that is out of
// order. `log.order` receives the counts of what was found.
void order_samples(GazeLog& log, UnorderedPolicy policy);
// Under the same policy, keeps the last row of each eye among rows of the same time.
void drop_duplicates(GazeLog& log, UnorderedPolicy policy);
// What is wrong with the first row that is out of order, or that repeats a time, in words for messages.
std::string unordered_problem(const GazeOrder& order);
std::string duplicate_problem(const GazeOrder& order);

// Origins come in the order of the file, where each eye may have a row of its own. Afterwards there is one for each
// sample.
void align_origins(GazeLog& log);

}  // namespace gazetrace
