// SPDX-License-Identifier: Apache-2.0
// The stamps of a log: counters that overflow, clocks that start again, rows out of order, at most one row for each eye
// at each time.
#pragma once

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Finds what is odd about the stamps as they stand in the file. Pairs of equal stamps and overflows are mended under
// the policy that says so, and else are faults; parts of a file between which the clock starts again become recordings.
void mend_stamps(RawGaze& raw, UnorderedPolicy policy);
// "the clock starts again in line 7: ", or nothing.
std::string words_of_restart(const RawGaze& raw);

// Whether keeping one of equal stamps would lose more than a few per cent of the rows.
bool loses_much(const GazeOrder& order);

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
