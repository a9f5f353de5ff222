// SPDX-License-Identifier: Apache-2.0
// Slurm: a script for sbatch, which is an array of the chunks and, by its argument, each task after them.
// https://slurm.schedmd.com/sbatch.html: --signal=B: reaches the batch shell alone, and --kill-on-invalid-dep ends a
// job whose dependency can no longer be fulfilled.
#include <fmt/format.h>

#include <algorithm>

#include "farm/engine.hpp"

namespace gazetrace {
namespace {

constexpr std::int64_t kNotice_s = 90;  // before the limit of time: USR1, upon which the frame in hand is finished

std::int64_t minutes(std::int64_t time_s) {
  return std::max<std::int64_t>((time_s + 59) / 60, 1);
}

std::string batch_script(const FarmPlan& plan) {
  std::string text = fmt::format(
      "#!/bin/sh\n#SBATCH --job-name={}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH "
      "--kill-on-invalid-dep=yes\n"
      "#SBATCH --signal=B:USR1@{}\n",
      plan.name, kNotice_s);
  if (plan.threads > 0) {
    text += fmt::format("#SBATCH --cpus-per-task={}\n", plan.threads);
  }
  if (plan.memory_mib > 0) {
    text += fmt::format("#SBATCH --mem={}M\n", plan.memory_mib);
  }
  if (plan.time_s > 0) {
    text += fmt::format("#SBATCH --time={}\n", minutes(plan.time_s));
  }
  return text + fmt::format("exec sh {} \"${{1:-$SLURM_ARRAY_TASK_ID}}\"\n", shell_word(task_script_path(plan)));
}

// Chunks of an earlier handing over that are in the queue or run are left to it, and what follows waits for them, too.
// `jobs` remembers which jobs there were, "chunks 17"; what followed the earlier chunks is canceled. While a node
// cleans up after a task (epilog, slow ends), nobody can see whether that task goes back into the queue or is gone, so
// this is waited for.
constexpr const char* kBesideEarlier = R"sh(
queued=
waited=0
known() { sed -n "s/^$1 //p" jobs 2>/dev/null; }
# squeue also fails for a job that it has forgotten, and tells nothing then. Where it cannot say what there is at all, a
# chunk that runs would be handed over twice.
squeue -h -o %A > /dev/null || { echo "Slurm does not list its queue: call again once it does" >&2; exit 3; }
for job in $(known chunks); do
  while [ "$waited" -lt 300 ] && [ -n "$(squeue -h -r -j "$job" -t CG -o %K 2>/dev/null)" ]; do
    sleep 1
    waited=$((waited + 1))
  done
  for task in $(squeue -h -r -j "$job" -t PD,R,S,CF -o %K 2>/dev/null); do
    queued="$queued ${job}_$task"
  done
done
for job in $(known after); do
  scancel "$job" 2>/dev/null || :
done
wanted=
after=
for chunk in $chunks; do
  case "$queued " in
    *_"$chunk "*) ;;
    *) wanted="$wanted${wanted:+,}$chunk" ;;
  esac
done
for task in $queued; do
  after="$after:$task"
done
if [ -n "$wanted" ]; then
  job=$(sbatch --parsable --array="$wanted" --output=logs/%a.log task.sbatch)
  echo "chunks $job" >> jobs
  echo "chunks: $job"
  after=":$job$after"
fi
submit() {
  job=$(sbatch --parsable ${after:+--dependency=afterok$after} $time_after --output="logs/$1.log" task.sbatch "$1")
  echo "after $job" >> jobs
  echo "$1: $job"
  after=":$job"
}
)sh";

std::string submit_script(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  std::string numbers;
  for (const std::size_t chunk : chunks) {
    numbers += fmt::format("{}{}", numbers.empty() ? "" : " ", chunk + 1);
  }
  std::string text = fmt::format(
      "#!/bin/sh\n# Hands this farm over to Slurm, and prints the numbers of its jobs.\nset -e\n"
      "cd {}\nmkdir -p logs\nchunks='{}'\ntime_after={}{}",
      shell_word(plan.folder), numbers,
      plan.time_s > 0 ? fmt::format("--time={}", minutes(time_after_chunks_s(plan))) : "", kBesideEarlier);
  for (const std::string& task : tasks_after_chunks(plan)) {
    text += "submit " + task + "\n";
  }
  return text;
}

std::map<std::string, std::string> files(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  return {{"task.sbatch", batch_script(plan)}, {"submit.sh", submit_script(plan, chunks)}};
}

std::string submit(const FarmPlan& plan) {
  return "sh " + shell_word(plan.folder + "/submit.sh");
}

// One task of an array has the array's own number for its SLURM_JOB_ID, and a requeue of that number puts every task of
// the array back, the finished ones, too: a task is named by array and index. Its tries are counted in a file, because
// SLURM_RESTART_COUNT also counts what others do to it, such as preemption.
std::string again(const FarmPlan& plan) {
  return fmt::format(
      R"(  tries=$(cat "$tasks/$1.tries" 2>/dev/null || echo 0)
  slurm_task=${{SLURM_ARRAY_TASK_ID:+${{SLURM_ARRAY_JOB_ID}}_}}${{SLURM_ARRAY_TASK_ID:-${{SLURM_JOB_ID:-}}}}
  if [ -n "$slurm_task" ] && [ "$tries" -lt {} ]; then
    echo $((tries + 1)) > "$tasks/$1.tries"
    for _ in 1 2 3; do  # a controller that is busy may refuse it once
      if scontrol requeue "$slurm_task"; then
        trap 'exit 4' TERM
        sleep 300 &
        wait  # Slurm ends this attempt
        break
      fi
      sleep 5
    done
  fi
)",
      plan.retries);
}

}  // namespace

const FarmEngine kFarmEngine_slurm{files, submit, again, " --progress never", true, false};

}  // namespace gazetrace
