// SPDX-License-Identifier: Apache-2.0
// From runs to results: intervals, ratios, fronts, controls. Nothing is rendered here.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/runs.hpp"

namespace gazetrace {

// What is known before anything is measured: title, build, machine, view, metrics.
Results facts_of_plan(const SweepPlan& plan);

// Scores of a row by its runs, the reference's error taken into account.
std::map<std::string, std::map<std::string, ResultScore>> row_scores(const std::vector<SweepRun>& runs,
                                                                     const ScoreTable& floor);
// `facts` with what follows from the measurements: rows with their times, scores and speed-ups, fronts, fixed quality,
// controls and notes.
Results conclude(Results facts, const SweepPlan& plan, const Measurements& measured);

// Every setting in a paragraph, ready to paste.
std::string sweep_methods(const SweepPlan& plan, const Results& results);

// Of what the tasks of a sweep ran on: every machine once.
ResultMachine machine_of_tasks(const std::map<std::string, std::string>& machines);

}  // namespace gazetrace
