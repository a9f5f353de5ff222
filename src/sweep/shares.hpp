// SPDX-License-Identifier: Apache-2.0
// How the rows of a sweep are divided among tasks, and the file that says so.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/scene_rows.hpp"

namespace gazetrace {

// The row by whose id the task is chosen that renders these pixels: the first of those that share them.
const PlannedRow& deciding_row(const SceneRows& rows, const PlannedRow& row);

// The ids of deciding rows that this task measures, with all rows that share their pixels and all that follow from
// measuring them. The first task writes the borders into the sweep's folder, exclusively, and the others read them.
std::set<std::string> rows_of_task(const SweepPlan& plan, const SweepTask& task);

}  // namespace gazetrace
