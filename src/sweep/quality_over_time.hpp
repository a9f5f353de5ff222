// SPDX-License-Identifier: Apache-2.0
// The rows of a place as points of quality over time: which no other beats, and how much later uniform rendering gets
// to a level than foveated rendering. The curves themselves: curves.cpp.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// As SweepResults::pareto, of rows that have their times and scores.
std::map<std::string, std::map<std::string, std::vector<std::string>>> pareto_fronts(
    const std::vector<std::string>& metrics, const std::vector<SweepRow>& rows);

// At each level of the plan, for each scene, gaze and family of foveated rows; `results` holds rows and references.
std::vector<SweepFixedQuality> speed_ups_at_quality(const SweepMeasure& measure, const SweepResults& results);

}  // namespace gazetrace
