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
  render,  // trace and write
  replay,  // complete, but later frames or a checkpoint need its history: trace, write nothing
  skip,
};

struct ResumePlan {
  std::vector<FrameWork> work;                  // one entry a frame of the plan
  std::map<std::int32_t, TimingRow> kept_rows;  // of frames that are not rendered again
  bool writes_checkpoint = false;               // one is asked for, and what is there is not it
  Warnings warnings;
};

// `history`: what the plan's first frame finds. A checkpoint that is asked for and not there, or not that of these
// frames, needs every frame anew.
ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const std::string& timing_path,
                       const TemporalHistory& history);

}  // namespace gazetrace
