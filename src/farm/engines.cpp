// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "farm/engine.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

std::vector<FarmEngineInfo> farm_engines() {
  return {
#define GAZETRACE_FARM_ENGINE(name, description) {#name, description},
#include "farm/engines.def"
#undef GAZETRACE_FARM_ENGINE
  };
}

const FarmEngine& farm_engine(const std::string& name) {
#define GAZETRACE_FARM_ENGINE(known, description) \
  if (name == #known) {                           \
    return kFarmEngine_##known;                   \
  }
#include "farm/engines.def"
#undef GAZETRACE_FARM_ENGINE
  std::vector<std::string> names;
  for (const FarmEngineInfo& info : farm_engines()) {
    names.push_back(info.name);
  }
  throw Error(ErrorKind::usage, "`engine`", unknown_name_message("engine", name, names));
}

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) {
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return word + "'";
}

std::string chunk_list(const std::vector<std::size_t>& chunks) {
  std::vector<std::int32_t> numbers;
  for (const std::size_t chunk : chunks) {
    numbers.push_back(static_cast<std::int32_t>(chunk) + 1);
  }
  return numbers.empty() ? std::string() : format_frame_list(numbers);
}

std::vector<std::string> tasks_after_chunks(const FarmPlan& plan) {
  std::vector<std::string> names{"finish"};
  for (std::size_t i = 1; i <= plan.then.size(); ++i) {
    names.push_back(fmt::format("after-{}", i));
  }
  return names;
}

std::vector<std::string> farm_tasks(const FarmPlan& plan) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= plan.chunks.size(); ++i) {
    names.push_back(std::to_string(i));
  }
  for (const std::string& name : tasks_after_chunks(plan)) {
    names.push_back(name);
  }
  return names;
}

std::map<std::string, std::string> farm_files(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  std::map<std::string, std::string> files = farm_engine(plan.engine).files(plan, chunks);
  files["task.sh"] = task_script(plan);
  return files;
}

std::string submit_command(const FarmPlan& plan) {
  return farm_engine(plan.engine).submit(plan);
}

bool can_retry_beside_running(const FarmPlan& plan) {
  return farm_engine(plan.engine).joins_running;
}

bool submit_waits(const FarmPlan& plan) {
  return farm_engine(plan.engine).waits;
}

std::int64_t time_after_chunks_s(const FarmPlan& plan) {
  constexpr std::int64_t kLeast_s = 3600;
  if (plan.time_s == 0) {
    return 0;
  }
  return std::max(plan.time_s, kLeast_s);
}

std::string task_script_path(const FarmPlan& plan) {
  return (std::filesystem::path(plan.folder) / "task.sh").string();
}

}  // namespace gazetrace
