// SPDX-License-Identifier: Apache-2.0
// Flamenco 3: a job type in JavaScript, which lies in the manager's folder `scripts`, and a job of it for the manager's
// API. https://flamenco.blender.org/usage/job-types/
#include <nlohmann/json.hpp>

#include "farm/engine.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kJobType = R"(// SPDX-License-Identifier: Apache-2.0
// The tasks of a farm of gazetrace: copy this file into the folder `scripts` beside the Flamenco Manager.
const JOB_TYPE = {
    label: "gazetrace farm",
    settings: [
        { key: "script", type: "string", required: true, description: "task.sh in the folder of the farm" },
        { key: "chunks", type: "string", required: true, description: "numbers of chunks: 1,2,3" },
        { key: "after", type: "string", required: true, description: "tasks that follow them, each after the other" },
    ],
};

function makeTask(job, name) {
    const task = author.Task(name, "misc");
    task.addCommand(author.Command("exec", { exe: "sh", args: [job.settings.script, name] }));
    return task;
}

function compileJob(job) {
    const chunks = job.settings.chunks.split(",").filter((name) => name !== "").map((name) => makeTask(job, name));
    let before = chunks;
    for (const chunk of chunks) {
        job.addTask(chunk);
    }
    for (const name of job.settings.after.split(",")) {
        const task = makeTask(job, name);
        for (const earlier of before) {
            task.addDependency(earlier);
        }
        job.addTask(task);
        before = [task];
    }
}
)";

std::map<std::string, std::string> files(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  std::string numbers;
  for (const std::size_t chunk : chunks) {
    numbers += (numbers.empty() ? "" : ",") + std::to_string(chunk + 1);
  }
  std::string after;
  for (const std::string& task : tasks_after_chunks(plan)) {
    after += (after.empty() ? "" : ",") + task;
  }
  const Json job{{"name", plan.name},
                 {"type", "gazetrace-farm"},
                 {"priority", 50},
                 {"submitter_platform", "linux"},
                 {"settings", {{"script", task_script_path(plan)}, {"chunks", numbers}, {"after", after}}}};
  return {{"gazetrace_farm.js", kJobType}, {"job.json", job.dump(2) + "\n"}};
}

std::string submit(const FarmPlan& plan) {
  return "curl --fail --silent --show-error --header 'Content-Type: application/json' --data @" +
         shell_word(plan.folder + "/job.json") + " \"${FLAMENCO_MANAGER:-http://localhost:8080}/api/v3/jobs\"";
}

std::string again(const FarmPlan& /*plan*/) {
  return {};
}

}  // namespace

const FarmEngine kFarmEngine_flamenco{files, submit, again, " --progress never", false};

}  // namespace gazetrace
