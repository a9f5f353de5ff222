// SPDX-License-Identifier: Apache-2.0
// The folder of a sweep, its tasks and their merge, from what scene_sweep.hpp measures to results.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "gazetrace/error.hpp"
#include "sweep/conclude.hpp"
#include "sweep/scene_sweep.hpp"
#include "sweep/sealed_json.hpp"
#include "sweep/shares.hpp"
#include "sweep/state.hpp"
#include "sweep/take_in.hpp"

namespace gazetrace {
namespace {

Results concluded(const SweepPlan& plan, const Measurements& measured) {
  Results results = conclude(facts_of_plan(plan), plan, measured);
  results.methods = sweep_methods(plan, results);
  return results;
}

SweepDirectory open_directory(const SweepPlan& plan, const std::optional<SweepTask>& task, const std::string& machine,
                              const SweepObserver& observer) {
  if (plan.tests.empty()) {
    throw Error(ErrorKind::usage, plan.plan_file, "there is nothing to measure", "give a [[setting]] or a [grid]");
  }
  std::error_code problem;
  std::filesystem::create_directories(plan.directory, problem);
  if (!std::filesystem::is_directory(plan.directory)) {
    throw Error(ErrorKind::input, plan.directory, "the folder cannot be made: " + problem.message(),
                "choose another `output` folder");
  }
  SweepDirectory directory(plan.directory, task);
  if (plan.restart) {
    clear_directory(plan.directory);
  }
  claim_directory(plan, plan.directory, machine);
  drop_damaged(plan.directory, plan.trust_files, plan.tests.front().pipeline.threads, observer);
  return directory;
}

}  // namespace

std::string SweepTask::label() const {
  return fmt::format("{}/{}", number, count);
}

SweepDirectory prepare_sweep(const SweepPlan& plan, const std::optional<SweepTask>& task,
                             const SweepObserver& observer) {
  if (task && plan.restart) {
    throw Error(ErrorKind::usage, "`restart`", "would delete the measurements of other chunks",
                "remove the folder, or leave it out");
  }
  return open_directory(plan, task, task ? kManyMachines : machine_description(), observer);
}

Results run_sweep(const SweepPlan& plan, const SweepObserver& observer) {
  Scope scope;
  Measurements measured;
  measure_scenes(plan, scope, measured, observer);
  return concluded(plan, measured);
}

void run_sweep_task(const SweepPlan& plan, const SweepTask& task, const SweepObserver& observer) {
  Scope scope;
  scope.kind = Scope::Kind::task;
  scope.rows = rows_of_task(plan, task);
  scope.label = task.label();
  if (scope.rows.empty()) {
    throw Error(ErrorKind::nothing_to_do, "`chunk`", fmt::format("chunk {} has none of the rows", task.label()));
  }
  Measurements measured;
  measure_scenes(plan, scope, measured, observer);
}

Results merge_sweep(const SweepPlan& plan, const std::vector<std::string>& folders, const SweepObserver& observer) {
  if (folders.empty()) {
    check_chunks_in(plan, plan.directory);
  }
  for (const std::string& folder : folders) {
    check_chunks_in(plan, folder);
  }
  const SweepDirectory directory = open_directory(plan, std::nullopt, kManyMachines, observer);
  for (const std::string& folder : folders) {
    take_in(folder, plan.directory);
  }
  if (!folders.empty()) {
    drop_damaged(plan.directory, plan.trust_files, plan.tests.front().pipeline.threads, observer);
  }
  Scope scope;
  scope.kind = Scope::Kind::merge;
  Measurements measured;
  measure_scenes(plan, scope, measured, observer);
  if (!scope.missing.empty()) {
    constexpr std::size_t kNamed = 8;
    const std::size_t named = std::min(scope.missing.size(), kNamed);
    throw Error(
        ErrorKind::input, plan.directory,
        fmt::format("{} of the sweep's parts are missing: {}{}", scope.missing.size(),
                    fmt::join(scope.missing.begin(), scope.missing.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                    named < scope.missing.size() ? ", ..." : ""),
        "run the unfinished chunks again; they keep their finished rows");
  }
  Results results = concluded(plan, measured);
  results.machine = machine_of_tasks(measured.machines);
  return results;
}

}  // namespace gazetrace
