// SPDX-License-Identifier: Apache-2.0
// From runs to what is printed: intervals, ratios, fronts, controls. Nothing is rendered here.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// Scores of a row by its runs, the reference's error taken into account.
std::map<std::string, std::map<std::string, SweepScore>> row_scores(const std::vector<SweepRun>& runs,
                                                                    const ScoreTable& floor);
double mean_of_runs(const SweepRow& row, double SweepRun::*member);
// What follows from rows that have their runs: speed-ups, equal times, fronts, fixed quality, controls.
void complete_tables(const SweepPlan& plan, SweepResults& results);

}  // namespace gazetrace
