// SPDX-License-Identifier: Apache-2.0
// What an interrupted run left behind, and what is still to be done.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

enum class FrameWork : std::uint8_t {
  render,  // trace and write
  replay,  // complete, but later frames need its history: trace, write nothing
  skip,
};

struct ResumePlan {
  std::vector<FrameWork> work;                  // one entry a frame of the plan
  std::map<std::int32_t, TimingRow> kept_rows;  // of frames that are not rendered again
  Warnings warnings;
};

ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const std::string& timing_path);

}  // namespace gazetrace
