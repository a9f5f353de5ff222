// SPDX-License-Identifier: Apache-2.0
// Measures the rows of a sweep, scene by scene: all of them, those of one task, or none, where tasks have.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/runs.hpp"

namespace gazetrace {

// Which rows are measured here: all of them, those of one task, or none, where tasks have measured them before.
struct Scope {
  enum class Kind : std::uint8_t { whole, task, merge };
  Kind kind = Kind::whole;
  std::set<std::string> rows;        // of a task: deciding rows, see shares.hpp
  std::string label;                 // of a task
  std::vector<std::string> missing;  // of a merge: what it did not find
};

// Whatever has been finished in the plan's folder is not done again.
void measure_scenes(const SweepPlan& plan, Scope& scope, Measurements& measured, const SweepObserver& observer);

}  // namespace gazetrace
