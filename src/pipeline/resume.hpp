// SPDX-License-Identifier: Apache-2.0
// What an interrupted run left behind, and what is still to be done.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

struct RunPaths {
  std::string record, timing;
};

struct ResumePlan {
  std::vector<bool> is_done;                    // one entry per frame of the plan: its files are complete
  std::map<std::int32_t, TimingRow> kept_rows;  // of frames that are not rendered again
  WrittenFiles kept_files;                      // the same of files
  Warnings warnings;
};

// `paths`: of the run record and of the timing; empty where nothing is written.
ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const RunPaths& paths);

}  // namespace gazetrace
