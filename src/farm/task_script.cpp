// SPDX-License-Identifier: Apache-2.0
// The script that runs a task of a farm, whichever engine calls it. It passes signals on to the program, so that a
// frame can be finished, and keeps the exit code for the status.
#include <fmt/format.h>

#include <string>

#include "farm/engine.hpp"
#include "farm/plan.hpp"

namespace gazetrace {
namespace {

// Seconds between the end of a run by `max-time` and the engine's own limit.
constexpr std::int64_t kReserve_s = 60;

constexpr const char* kBeginning = R"(#!/bin/sh
# Runs tasks of the farm in this folder: task.sh 3, task.sh 3-5,8, task.sh finish, task.sh after-1.
# Exit codes are those of gazetrace: 2 will fail again, 3 may be worth another try, 4 was interrupted and goes on.
)";

constexpr const char* kRunning = R"(
child=
ended=0  # asked from outside to end: the task is not put into the queue again
# Of a program, it alone is told of a signal; of a shell's command (command=1), all that it has begun, itself first, so
# that it begins nothing else. As the kernel lists them; where it does not, the shell alone.
begun() { echo "$1"; for one in $(cat "/proc/$1/task/$1/children" 2>/dev/null); do begun "$one"; done; }
command=0
pass() {
  [ -z "$child" ] && return
  if [ "$command" -eq 1 ]; then
    kill "-$1" $(begun "$child") 2>/dev/null
  else
    kill "-$1" "$child" 2>/dev/null
  fi
}
trap 'ended=1; pass TERM' TERM INT
trap 'pass USR1' USR1 XCPU

run() {
  name=$1
  shift
  rm -f "$tasks/$name.exit"
  # A lock that tells the status that the task runs, and goes with the last process that holds it.
  exec 9>"$tasks/$name.running"
  command -v flock >/dev/null && flock -s 9
  "$@" &
  child=$!
  while :; do
    wait "$child"
    code=$?
    # A signal ends the waiting, and not the child.
    { [ "$code" -gt 128 ] && kill -0 "$child" 2>/dev/null; } || break
  done
  child=
  exec 9>&-
  echo "$code" > "$tasks/.$name.$$" && mv "$tasks/.$name.$$" "$tasks/$name.exit"
  return "$code"
}

each_chunk() {
  for part in $(echo "$1" | tr ',' ' '); do
    case $part in
      *-*) seq "${part%-*}" "${part#*-}" ;;
      *) echo "$part" ;;
    esac
  done
}
)";

// The program with what stands before it, for the shell.
std::string program_words(const FarmPlan& plan) {
  return (plan.container.empty() ? std::string() : plan.container + " ") + shell_word(plan.program);
}

std::string limits(const FarmPlan& plan, std::int64_t time_s) {
  std::string words = plan.confine ? " --confine" : "";
  if (plan.threads > 0) {
    words += fmt::format(" --threads {}", plan.threads);
  }
  if (time_s > 2 * kReserve_s) {
    words += fmt::format(" --max-time {}s", time_s - kReserve_s);
  }
  return plan.kind == FarmKind::sweep ? words : words + farm_engine(plan.engine).progress;
}

// A pattern of the pictures that lets a merge find the parts.
std::string pattern_of(const std::string& run_name) {
  std::string pattern;
  for (const char letter : run_name.substr(run_name.rfind('/') + 1)) {
    pattern += letter == '%' ? "%%" : std::string(1, letter);
  }
  return run_name.substr(0, run_name.rfind('/') + 1) + pattern + ".####";
}

std::string finish_words(const FarmPlan& plan) {
  if (plan.kind == FarmKind::sweep) {
    return fmt::format("{} sweep merge {} -o {}{}", program_words(plan), shell_word(plan.job_file),
                       shell_word(plan.run_folder), plan.confine ? " --confine" : "");
  }
  return fmt::format("{} merge {} --overwrite", program_words(plan), shell_word(pattern_of(run_name_of(plan))));
}

// What runs chunk $1.
std::string chunk_words(const FarmPlan& plan) {
  const std::string program = program_words(plan);
  const std::string job = shell_word(plan.job_file);
  const std::string chunk = fmt::format("--chunk \"$1/{}\"{}", plan.chunks.size(), limits(plan, plan.time_s));
  if (plan.kind == FarmKind::sweep) {
    return fmt::format("  run \"$1\" {} sweep {} -o {} {}\n", program, job, shell_word(plan.run_folder), chunk);
  }
  return fmt::format("  run \"$1\" {} render --config {} --resume {}\n", program, job, chunk);
}

}  // namespace

std::string task_script(const FarmPlan& plan) {
  std::string text = kBeginning;
  text += fmt::format("tasks={}\nmkdir -p \"$tasks\" && cd {} || exit 3\n", shell_word(plan.folder + "/tasks"),
                      shell_word(plan.work_folder));
  text += kRunning;
  text += fmt::format(R"(
chunk() {{
{}}}

code=0
case $1 in
  finish)
    run finish {}
    code=$?
    ;;
)",
                      chunk_words(plan), finish_words(plan));
  for (std::size_t i = 0; i < plan.then.size(); ++i) {
    text += fmt::format("  after-{0})\n    command=1\n    run after-{0} sh -c {1}\n    code=$?\n    ;;\n", i + 1,
                        shell_word(plan.then[i]));
  }
  text += R"(  *)
    worst=0
    for number in $(each_chunk "$1"); do
      chunk "$number"
      code=$?
      if [ "$worst" -eq 0 ] || { [ "$code" -ne 0 ] && [ "$worst" -eq 4 ]; } || { [ "$code" -ne 4 ] && [ "$code" -gt "$worst" ]; }; then
        worst=$code
      fi
      { [ "$code" -eq 4 ] || [ "$ended" -eq 1 ]; } && break
    done
    code=$worst
    ;;
esac
)";
  const std::string again = farm_engine(plan.engine).again(plan);
  if (!again.empty()) {
    text += fmt::format(R"(
if [ "$ended" -eq 0 ] && {{ [ "$code" -eq 3 ] || [ "$code" -eq 4 ] || [ "$code" -gt 128 ]; }}; then
{}fi
)",
                        again);
  }
  return text + "exit \"$code\"\n";
}

}  // namespace gazetrace
