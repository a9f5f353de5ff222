// SPDX-License-Identifier: Apache-2.0
// What `compare` prints and writes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gazetrace/compare.hpp"

namespace gazetrace {

// frame,gaze,metric,value,weighted,map_min,...,map_max and one column a band and a region.
std::string compare_csv_header();
std::string compare_csv_rows(const FrameScores& frame);

// What the scores depend on, by name, in the order of printing.
using CompareConditions = std::vector<std::pair<std::string, std::string>>;
std::string compare_text(const CompareConditions& conditions, const std::vector<SequenceScores>& summary);
std::string compare_json(const CompareConditions& conditions, const std::vector<SequenceScores>& summary,
                         const std::vector<FrameScores>& frames);

}  // namespace gazetrace
