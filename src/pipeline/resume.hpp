// SPDX-License-Identifier: Apache-2.0
// What an interrupted run left behind, and what is still to be done.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

enum class FrameWork : std::uint8_t {
  render,  // trace it and write its files
  replay,  // its files are complete, but later frames or a checkpoint need its history: trace it and write nothing
  skip,
};

struct ResumePlan {
  std::vector<FrameWork> work;                  // one entry per frame of the plan
  std::map<std::int32_t, TimingRow> kept_rows;  // of frames that are not rendered again
  bool writes_checkpoint = false;               // one is asked for, and the file is missing or another one
  Warnings warnings;
};

// `history` is what the plan's first frame finds. Where a checkpoint is asked for that is missing, or that belongs to
// other frames, every frame is traced anew.
ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const std::string& timing_path,
                       const TemporalHistory& history);

}  // namespace gazetrace
