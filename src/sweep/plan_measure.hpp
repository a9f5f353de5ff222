// SPDX-License-Identifier: Apache-2.0
// [measure] of a sweep's plan as the library takes it.
#pragma once

#include <optional>

#include "gazetrace/sweep.hpp"
#include "sweep/plan_file.hpp"

namespace gazetrace {

// `threads`, where given, are those of the metrics; else all. Error(input) with the plan's line for rates and levels of
// quality that are none.
SweepMeasure sweep_measure(const SweepFile& file, const std::optional<int>& threads);

}  // namespace gazetrace
