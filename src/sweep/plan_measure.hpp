// SPDX-License-Identifier: Apache-2.0
// [measure] of a sweep's plan, as settings of the library.
#pragma once

#include <optional>

#include "gazetrace/sweep.hpp"
#include "sweep/plan_file.hpp"

namespace gazetrace {

// `threads`, where given, is the number of threads for the metrics; otherwise they use all. Throws Error(input) with
// the plan's line for texts that are not rates or levels of quality.
SweepMeasure sweep_measure(const SweepFile& file, const std::optional<int>& threads);

}  // namespace gazetrace
