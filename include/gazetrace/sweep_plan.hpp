// SPDX-License-Identifier: Apache-2.0
// From a sweep's plan in TOML to its rows: every combination of scene, gaze and setting,
// as a loaded, checked and planned job. Nothing is rendered.
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

// Whether a TOML file is the plan of a sweep, and not a job; by its tables alone. False for a file that cannot be read.
bool is_sweep_plan(const std::string& path);

// `frames` and `threads`, where given, replace those of the plan. The stages that options touch, by `schema`,
// decide which of them rows share with their reference and their uniform frames. Throws Error(usage, input)
// whose message is one line and names the line of the plan that is at fault, where there is one. `confine`: the plan is
// not trusted, and one that names a file outside of its own folder or data set is refused before anything is opened.
LoadedSweepPlan load_sweep_plan(const std::string& path, const std::optional<FrameList>& frames = {},
                                const std::optional<int>& threads = {}, const JobSchema& schema = job_schema(),
                                bool confine = false);

}  // namespace gazetrace
