// SPDX-License-Identifier: Apache-2.0
// A job from its settings to its files and its record: `gazetrace render`, and Job.render() in Python.
//   const FinishedRun run = run_job(load_job("job.toml"));
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// A run whose inputs are loaded and checked, whose outputs are claimed, and whose first frame comes next.
struct StartedRun {
  const ResolvedJob& resolved;
  const PathTracer& tracer;
  std::shared_ptr<ColorPipeline> color;
  std::vector<std::string> files;  // output_files() of the run
};

// Called from the thread of run_job(), unless they say otherwise. Any of them may be empty. A run is ended by
// `stop_before_frame` and `stop_now`; its record then says that it was interrupted.
struct RunObserver : PipelineObserver {
  std::function<void(std::size_t done, std::size_t total)> loading;  // see ResolveOptions
  std::function<void()> building_tree;                               // the scene is loaded, which may take as long
  // The arguments must outlive run_job().
  std::function<void(const StartedRun& run)> begins;
  // Whether to give up the frame in hand. Asked often, and from many threads.
  std::function<bool()> stop_now;
};

struct RunOptions {
  std::vector<std::string> command_line;  // for the record; may be empty
  const Scene* loaded = nullptr;          // see ResolveOptions
  // Frames are looked at through the observer, so that AOVs are there without an EXR that holds them.
  bool shows_frames = false;
  // How settings are named in the texts of the record; empty: in back quotes, as everywhere in the library.
  std::function<std::string(const std::string& text)> words;
};

struct FinishedRun {
  ResolvedJob resolved;
  RunRecord record;
  SequenceResult result;
  Warnings warnings;  // result_warnings(); those of before are in `resolved`
  double wall_s = 0;  // of all frames
};

// Checks and resolves the job, prepares its outputs and claims them, renders, and keeps the run's record beside the
// pictures: it is written when the run begins and when it ends, so that a killed run has one, too. Throws the errors of
// resolve(), lock_outputs(), prepare_outputs() and render_sequence(). Where a stated quality turns out to be out of
// reach before any picture was begun, the record of an earlier run is put back.
FinishedRun run_job(const Job& job, const RunObserver& observer = {}, const RunOptions& options = {});

}  // namespace gazetrace
