// SPDX-License-Identifier: Apache-2.0
// What an interrupted run left behind, and what is still to be done.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

struct RunPaths {
  std::string record, timing;
};

enum class FrameWork : std::uint8_t {
  render,  // trace it and write its files
  replay,  // its files are complete, but later frames or a checkpoint need its history: trace it and write nothing
  skip,
};

struct ResumePlan {
  std::vector<FrameWork> work;                  // one entry per frame of the plan
  std::map<std::int32_t, TimingRow> kept_rows;  // of frames that are not rendered again
  WrittenFiles kept_files;                      // the same of files
  bool writes_checkpoint = false;               // one is asked for, and the file is missing or another one
  // The history after the last frame of `work` that is skipped from the beginning on, from the checkpoint that an
  // interrupted run left; empty: it is made anew where it is needed.
  std::optional<TemporalHistory> taken_up;
  Warnings warnings;
};

// `paths`: of the run record and of the timing; empty where nothing is written. `history` is what the plan's first
// frame finds. Where frames or a checkpoint need a history that no file holds, the frames behind it are traced anew.
ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const RunPaths& paths,
                       const TemporalHistory& history);

}  // namespace gazetrace
