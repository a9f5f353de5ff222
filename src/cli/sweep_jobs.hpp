// SPDX-License-Identifier: Apache-2.0
// From a plan's text to what the library measures: every combination of scene, gaze and setting as a loaded, checked
// and planned job. Nothing is rendered.
#pragma once

#include <optional>
#include <string>

#include "cli/sweep_file.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {

struct SweepJobs {
  SweepPlan plan;
  Warnings warnings;
};

// `frames` and `threads`, where given, take the place of the plan's. Error(usage, input) in one line with the plan's
// line where one is to blame.
SweepJobs make_sweep_jobs(const SweepFile& file, const std::optional<FrameList>& frames,
                          const std::optional<int>& threads);

}  // namespace gazetrace
