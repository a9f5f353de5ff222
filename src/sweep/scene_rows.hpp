// SPDX-License-Identifier: Apache-2.0
// The rows of one scene of a sweep, in the order of the tables, each once.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "sweep/rows.hpp"

namespace gazetrace {

class SceneRows {
 public:
  // The tests and all rows that are known before anything is measured.
  SceneRows(const SweepPlan& plan, std::size_t scene, std::vector<std::string>& notes);

  // Adds rows beside a test, where there are none with the same pixels, gaze and reference, and tells the test of them.
  void add_baselines(std::size_t test, std::vector<PlannedRow> rows);

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] std::size_t tests() const { return tests_; }  // that come first
  PlannedRow& operator[](std::size_t i) { return rows_[i]; }
  const PlannedRow& operator[](std::size_t i) const { return rows_[i]; }
  [[nodiscard]] auto begin() const { return rows_.begin(); }
  [[nodiscard]] auto end() const { return rows_.end(); }

  // All rows that show the same pixels as this one, itself among them, in the order of the rows.
  [[nodiscard]] std::vector<const PlannedRow*> sharing(const PlannedRow& row) const;

 private:
  std::string add(PlannedRow row);

  std::deque<PlannedRow> rows_;  // a row keeps its address when others are added
  std::size_t tests_ = 0;
};

}  // namespace gazetrace
