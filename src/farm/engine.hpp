// SPDX-License-Identifier: Apache-2.0
// What differs between engines: the files that they read, and how these are handed over.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/file_lock.hpp"
#include "gazetrace/farm.hpp"

namespace gazetrace {

struct FarmEngine {
  // By names within the farm's folder.
  std::map<std::string, std::string> (*files)(const FarmPlan& plan, const std::vector<std::size_t>& chunks);
  // A command of the shell; empty: nothing is handed over.
  std::string (*submit)(const FarmPlan& plan);
  // What the script of the tasks does about a task that may be tried again, as commands of the shell; empty: the engine
  // tries again by itself.
  std::string (*again)(const FarmPlan& plan);
  // Options of `render` that the engine understands the output of.
  const char* progress;
  // Whether chunks can be handed over while others run, and what follows waits for both.
  bool joins_running;
  // Whether what submit() tells ends when the last task has.
  bool waits;
};

#define GAZETRACE_FARM_ENGINE(name, description) extern const FarmEngine kFarmEngine_##name;
#include "farm/engines.def"
#undef GAZETRACE_FARM_ENGINE

// Error(usage) for an engine that is not there.
const FarmEngine& farm_engine(const std::string& name);

// A text as one word of the shell.
std::string shell_word(const std::string& text);
// Chunks as they are named outside, counted from 1: "1-3,5".
std::string chunk_list(const std::vector<std::size_t>& chunks);
// The names of the tasks that follow the chunks, in their order: each waits for the one before.
std::vector<std::string> tasks_after_chunks(const FarmPlan& plan);
// The limit of time of a task that follows the chunks, in seconds; 0: none. It is an hour at least.
std::int64_t time_after_chunks_s(const FarmPlan& plan);
// Nobody else runs tasks of the farm as processes, or writes its files, while it is held. Error(runtime) where somebody
// does.
FileLock lock_farm(const FarmPlan& plan);
std::string task_script_path(const FarmPlan& plan);
std::string task_script(const FarmPlan& plan);
std::string farm_plan_json(const FarmPlan& plan);

}  // namespace gazetrace
