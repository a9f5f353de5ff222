// SPDX-License-Identifier: Apache-2.0
// The rows of a scene and gaze as points of quality over time: which of them no other beats, and how much later uniform
// rendering reaches a level of quality than foveated rendering. The curves themselves are in curves.cpp.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/runs.hpp"

namespace gazetrace {

// What Results::pareto holds, from rows that have their times and scores.
std::map<std::string, std::map<std::string, std::vector<std::string>>> pareto_fronts(
    const std::vector<std::string>& metrics, const std::vector<MeasuredRow>& rows);

// At each level of the plan, for each scene, gaze and family of foveated rows.
std::vector<ResultFixedQuality> speed_ups_at_quality(const SweepMeasure& measure,
                                                     const std::vector<ResultReference>& references,
                                                     const std::vector<MeasuredRow>& rows);

}  // namespace gazetrace
