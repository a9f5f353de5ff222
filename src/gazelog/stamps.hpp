// SPDX-License-Identifier: Apache-2.0
// The stamps of a log: counters that overflow, clocks that start again, rows out of order, at most one row for each eye
// at each time.
#pragma once

#include <cstddef>
#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// Finds what is odd about the stamps as they stand in the file. Pairs of equal stamps and overflows are mended under
// the policy that says so, and else are faults; parts of a file between which the clock starts again become recordings.
void mend_stamps(RawGaze& raw, UnorderedPolicy policy);
// "the clock starts again in line 7: ", or nothing.
std::string words_of_restart(const RawGaze& raw);

// Whether two places are the same in every number, of which some may be unknown in both.
bool is_same_place(const Vec3d& a, const Vec3d& b);

// Whether keeping one of equal stamps would lose more than a few per cent of the rows.
bool loses_much(const GazeOrder& order);

// The indices of the rows in the order of time; empty where they stand in it. `log.order` receives the counts of what
// was found. Unless they are to be sorted, throws Error(input) naming the first row that is out of order.
std::vector<std::size_t> rows_by_time(const RawRows& rows, UnorderedPolicy policy, GazeLog& log);
// Under the same policy, warns of the rows that were dropped because `log.order` counted them as duplicates, or throws.
void refuse_duplicates(UnorderedPolicy policy, GazeLog& log);
// What is wrong with the first row that is out of order, or that repeats a time, in words for messages.
std::string unordered_problem(const GazeOrder& order);
std::string duplicate_problem(const GazeOrder& order);

// Origins come in the order of the file, where each eye may have a row of its own. Afterwards there is one for each
// sample.
void align_origins(GazeLog& log);

// A step between neighbouring samples that is longer than this many median steps is a gap.
inline constexpr double kGapInSteps = 3;

// The samples with which a section begins that was recorded without a pause: the first one, and those that are the
// first at or after the begin of a segment of the recording. Increasing; of a log with at least one sample.
std::vector<std::size_t> section_starts(const GazeLog& log);

// The timing of a log with at least one sample.
GazeTiming measure_timing(const GazeLog& log);

}  // namespace gazetrace
