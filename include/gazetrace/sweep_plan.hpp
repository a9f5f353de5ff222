// SPDX-License-Identifier: Apache-2.0
// From a sweep's plan as it is written, in TOML, to what is measured: every combination of scene, gaze and setting as a
// loaded, checked and planned job. Nothing is rendered.
#pragma once

#include <optional>
#include <string>

#include "gazetrace/job.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {

struct LoadedSweepPlan {
  SweepPlan plan;
  Warnings warnings;
};

// `frames` and `threads`, where given, take the place of the plan's. What rows share with their reference and with the
// uniform frames beside them follows from what their options touch, as `schema` says it. Error(usage, input) in one
// line with the plan's line where one is to blame.
LoadedSweepPlan load_sweep_plan(const std::string& path, const std::optional<FrameList>& frames = {},
                                const std::optional<int>& threads = {}, const JobSchema& schema = job_schema());

}  // namespace gazetrace
