// SPDX-License-Identifier: Apache-2.0
// A row of a sweep's tables, which was measured once, for tests of the tables.
#pragma once

#include <string>

#include "sweep/runs.hpp"

namespace gazetrace {

inline MeasuredRow row_of_box(const std::string& id, double time_s) {
  MeasuredRow row;
  row.id = id;
  row.scene = "box";
  row.gaze = "left";
  row.curve = "one";
  row.reference = "box-a";
  row.runs.resize(1);
  row.runs.front().time_s = time_s;
  return row;
}

}  // namespace gazetrace
