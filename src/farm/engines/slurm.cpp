// SPDX-License-Identifier: Apache-2.0
// Slurm: a script for sbatch, which is an array of the chunks and, by its argument, each task after them.
// https://slurm.schedmd.com/sbatch.html: --signal=B: reaches the batch shell alone, --kill-on-invalid-dep ends a job
// whose dependency can no longer be fulfilled, and a requeued job counts SLURM_RESTART_COUNT.
#include <fmt/format.h>

#include <algorithm>

#include "farm/engine.hpp"

namespace gazetrace {
namespace {

constexpr std::int64_t kNotice_s = 90;  // before the limit of time: USR1, upon which the frame in hand is finished

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
    text += fmt::format("#SBATCH --time={}\n", std::max<std::int64_t>((plan.time_s + 59) / 60, 1));
  }
  return text + fmt::format("exec sh {} \"${{1:-$SLURM_ARRAY_TASK_ID}}\"\n", shell_word(task_script_path(plan)));
}

std::string submit_script(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  const std::string folder = shell_word(plan.folder);
  std::string text = fmt::format(
      "#!/bin/sh\n# Hands this farm over to Slurm, and prints the numbers of its jobs.\nset -e\n"
      "cd {}\nmkdir -p logs\n",
      folder);
  std::string depends;
  if (!chunks.empty()) {
    text += fmt::format("job=$(sbatch --parsable --array={} --output=logs/%a.log task.sbatch)\necho \"chunks: $job\"\n",
                        chunk_list(chunks));
    depends = "--dependency=afterok:$job ";
  }
  for (const std::string& task : tasks_after_chunks(plan)) {
    text += fmt::format("job=$(sbatch --parsable {0}--output=logs/{1}.log task.sbatch {1})\necho \"{1}: $job\"\n",
                        depends, task);
    depends = "--dependency=afterok:$job ";
  }
  return text;
}

std::map<std::string, std::string> files(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  return {{"task.sbatch", batch_script(plan)}, {"submit.sh", submit_script(plan, chunks)}};
}

std::string submit(const FarmPlan& plan) {
  return "sh " + shell_word(plan.folder + "/submit.sh");
}

std::string again(const FarmPlan& plan) {
  return fmt::format(
      R"(  if [ -n "${{SLURM_JOB_ID:-}}" ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt {} ] && scontrol requeue "$SLURM_JOB_ID"; then
    trap 'exit 4' TERM
    sleep 60 &
    wait  # Slurm ends this attempt
  fi
)",
      plan.retries);
}

}  // namespace

const FarmEngine kFarmEngine_slurm{files, submit, again, " --progress never"};

}  // namespace gazetrace
