// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <system_error>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/interruption.hpp"
#include "cli/json_output.hpp"
#include "cli/own_program.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/farm.hpp"

namespace gazetrace {
namespace {

struct FarmArguments {
  FarmSettings settings;
  std::string memory, time;
  std::string folder;  // of status and retry
  int processes = 1;
  bool submit = false;
  JsonOutput json;
};

std::vector<std::size_t> all_chunks(const FarmPlan& plan) {
  std::vector<std::size_t> chunks(plan.chunks.size());
  std::iota(chunks.begin(), chunks.end(), std::size_t{0});
  return chunks;
}

// Of tasks that have all ended: what became of them.
int tell_end(const FarmPlan& plan, int code) {
  const FarmStatus status = farm_status(plan);
  print_result(farm_status_text(plan, status));
  if (code == 0 && !status.is_done()) {
    throw Error(ErrorKind::runtime, plan.run_folder,
                "every task ended with 0, and yet files are missing or are not as they were written",
                "'gazetrace farm retry " + plan.run_folder + "' makes them again");
  }
  if (code != 0) {
    std::fprintf(stderr, "gazetrace: %s; its log is in %s/logs, and 'gazetrace farm retry %s' goes on\n",
                 code == exit_interrupted ? "interrupted" : "a task has failed", plan.folder.c_str(),
                 plan.run_folder.c_str());
  }
  return code;
}

int run_here(const FarmPlan& plan, const std::vector<std::size_t>& chunks, int processes, Interruption& interruption) {
  LocalSettings local;
  local.processes = processes;
  local.stop = [&] { return interruption.stop_before_frame(0); };
  local.tell = [](const std::string& task, const std::string& what) {
    std::fprintf(stderr, "task %s: %s\n", task.c_str(), what.c_str());
  };
  return tell_end(plan, run_local(plan, chunks, local));
}

// Made before the first thread, so that its signals reach no other; the tasks have grace times of their own.
std::unique_ptr<Interruption> watch_signals(const std::string& engine) {
  if (engine == "local") {
    return std::make_unique<Interruption>(std::chrono::hours(24), std::nullopt);
  }
  let_signals_go();  // programs of other engines would inherit that they are held
  return nullptr;
}

int hand_over(const FarmPlan& plan, const std::vector<std::size_t>& chunks, const FarmArguments& arguments,
              Interruption* interruption) {
  write_farm(plan, chunks);
  const std::string command = submit_command(plan);
  if (command.empty() && interruption != nullptr) {
    interruption->frames_begin();
    return run_here(plan, chunks, arguments.processes, *interruption);
  }
  if (!arguments.submit) {
    print_result(fmt::format("{} is written; hand it over with --submit, or by\n  {}\n", plan.folder, command));
    return exit_done;
  }
  std::fflush(nullptr);
  const int state = std::system(command.c_str());  // NOLINT: the command of the shell that was printed
  const int failed = state == 0 ? exit_done : farm_status(plan).exit_code();
  const bool was_found = state == 0 || (WIFEXITED(state) && WEXITSTATUS(state) != 126 && WEXITSTATUS(state) != 127);
  if (submit_waits(plan) && was_found && (state == 0 || failed != 0)) {
    return tell_end(plan, failed);
  }
  if (state != 0) {
    throw Error(ErrorKind::runtime, plan.engine, "did not take the farm: " + command, "see its message above");
  }
  return exit_done;
}

int run_farm(FarmArguments& arguments) {
  FarmSettings& settings = arguments.settings;
  if (settings.job_file.empty()) {
    throw Error(ErrorKind::usage, "", "no job was given", "gazetrace farm JOB.toml --engine slurm --chunks 8");
  }
  if (!arguments.memory.empty()) {
    parse_value(arguments.memory, "`memory`", settings.memory);
  }
  if (!arguments.time.empty()) {
    DurationNs time;
    parse_value(arguments.time, "`time`", time);
    settings.time = time;
  }
  if (settings.program.empty()) {
    settings.program = own_program().string();
  }
  const std::unique_ptr<Interruption> interruption = watch_signals(settings.engine);
  const FarmPlan plan = plan_farm(settings);
  std::fputs(farm_plan_text(plan).c_str(), stderr);
  return hand_over(plan, all_chunks(plan), arguments, interruption.get());
}

int run_status(const FarmArguments& arguments) {
  let_signals_go();
  const FarmPlan plan = read_farm(arguments.folder);
  const FarmStatus status = farm_status(plan);
  arguments.json.print(farm_status_text(plan, status), [&] { return farm_status_json(plan, status); });
  return status.exit_code();
}

int run_retry(const FarmArguments& arguments) {
  const FarmPlan plan = read_farm(arguments.folder);
  if (plan.is_moved) {
    throw Error(ErrorKind::input, plan.folder, "the farm was made for another folder, and its tasks would write there",
                "call 'gazetrace farm' again for a job whose outputs are here");
  }
  const std::unique_ptr<Interruption> interruption = watch_signals(plan.engine);
  const FarmStatus status = farm_status(plan, FileCheck::content);
  if (status.is_done()) {
    throw Error(ErrorKind::nothing_to_do, arguments.folder, "every task is done");
  }
  for (std::size_t i = 0; i < status.tasks.size(); ++i) {
    const TaskStatus& task = status.tasks[i];
    if (task.state == TaskState::running && (i >= plan.chunks.size() || !can_retry_beside_running(plan))) {
      throw Error(ErrorKind::usage, arguments.folder,
                  "task " + task.name + " is running, and the tasks after it wait for it",
                  "wait until it ends, or end it");
    }
    if (task.state == TaskState::unknown) {
      throw Error(ErrorKind::usage, arguments.folder,
                  "whether task " + task.name + " still runs cannot be told, since nothing can be locked there",
                  "end it where it runs, and call 'gazetrace farm' again, which keeps finished work");
    }
  }
  return hand_over(plan, chunks_to_retry(status), arguments, interruption.get());
}

std::string engines_text() {
  std::string text;
  for (const FarmEngineInfo& info : farm_engines()) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", info.name, info.description);
  }
  return text;
}

void add_hand_over_options(CLI::App& app, FarmArguments& arguments) {
  app.add_flag("--submit", arguments.submit, "Hands the files over to the engine; local always runs");
  app.add_option("--processes", arguments.processes, "local: so many tasks at the same time")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
}

}  // namespace

Command add_farm_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<FarmArguments>();
  FarmSettings& settings = arguments->settings;
  app.add_option("job", settings.job_file,
                 "A settings file as 'render' takes it, with frames and output, or the plan of a sweep")
      ->type_name("JOB.toml");
  app.add_option("--engine", settings.engine, "Which queue runs the tasks; " + engines_text())
      ->default_str("local")
      ->type_name("NAME");
  settings.engine = "local";
  app.add_option("--chunks", settings.chunks,
                 "Divides the frames, or the rows of a sweep, into N tasks of about equal cost")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  app.add_option("-o,--output", settings.output, "Of a sweep: its folder; default: the plan's name with .sweep")
      ->type_name("FOLDER");
  app.add_option("--threads", settings.threads, "Of each task; 0: as many as its machine has")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  app.add_option("--retries", settings.retries, "How often a task is tried again that was interrupted or killed")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  app.add_option("--memory", arguments->memory,
                 "Of each task, such as 8G; default: by the scene and the pictures' size")
      ->type_name("BYTES");
  app.add_option("--time", arguments->time, "Limit of each task, such as 2h; default: none")->type_name("DURATION");
  app.add_option("--container", settings.container, "Words before the program, such as 'apptainer exec gazetrace.sif'")
      ->type_name("WORDS");
  app.add_option("--program", settings.program, "gazetrace as the tasks find it; default: this one")->type_name("FILE");
  app.add_option("--then", settings.then,
                 "A command of the shell for when the sequence is whole, such as 'gazetrace video out/f.####.png "
                 "-o film.mp4'; each waits for the one before")
      ->type_name("COMMAND");
  app.add_flag("--confine", settings.confine,
               "For a job by others: it may name no file outside of its folder or data set, and nor may its tasks");
  add_hand_over_options(app, *arguments);

  CLI::App* const status = app.add_subcommand("status", "Print the state of each task, and the rest of the work");
  status->footer(kExitCodesHelp);
  status->add_option("folder", arguments->folder, "Where the job writes its outputs")->required()->type_name("DIR");
  add_json_option(*status, arguments->json);
  CLI::App* const retry =
      app.add_subcommand("retry", "Repeat the tasks that are neither done nor running, and those that depend on them");
  retry->footer(kExitCodesHelp);
  retry->add_option("folder", arguments->folder, "Where the job writes its outputs")->required()->type_name("DIR");
  add_hand_over_options(*retry, *arguments);
  app.require_subcommand(0, 1);

  const auto run = [arguments, status, retry] {
    return status->parsed() ? run_status(*arguments) : retry->parsed() ? run_retry(*arguments) : run_farm(*arguments);
  };
  return {run, {}, true};
}

}  // namespace gazetrace
