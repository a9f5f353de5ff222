// SPDX-License-Identifier: Apache-2.0
#include "sweep/scene_rows.hpp"

#include <utility>

namespace gazetrace {

SceneRows::SceneRows(const SweepPlan& plan, std::size_t scene, std::vector<std::string>& notes) {
  for (std::size_t t = 0; t < plan.tests.size(); ++t) {
    if (plan.tests[t].scene == scene) {
      rows_.push_back(test_row(plan, t));
    }
  }
  tests_ = rows_.size();
  for (std::size_t t = 0; t < tests_; ++t) {
    add_baselines(t, baselines_known_before(plan, rows_[t], notes));
  }
}

// The id of the row that is there then. Every test has its own row of equal time, whose time is compared with that of
// the test.
std::string SceneRows::add(PlannedRow row) {
  for (const PlannedRow& other : rows_) {
    if (row.row.role != RowRole::equal_time && other.digest == row.digest && other.row.gaze == row.row.gaze &&
        other.row.reference == row.row.reference) {
      return other.row.id;
    }
  }
  rows_.push_back(std::move(row));
  return rows_.back().row.id;
}

void SceneRows::add_baselines(std::size_t test, std::vector<PlannedRow> rows) {
  for (PlannedRow& row : rows) {
    const RowRole role = row.row.role;
    const std::string id = add(std::move(row));
    if (role != RowRole::wrong_gaze && role != RowRole::uniform_rate) {
      rows_[test].row.baselines[to_string(role)] = id;
    }
  }
}

std::vector<const PlannedRow*> SceneRows::sharing(const PlannedRow& row) const {
  std::vector<const PlannedRow*> rows;
  for (const PlannedRow& other : rows_) {
    if (other.digest == row.digest && other.row.reference == row.row.reference) {
      rows.push_back(&other);
    }
  }
  return rows;
}

}  // namespace gazetrace
