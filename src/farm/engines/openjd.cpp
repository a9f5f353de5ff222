// SPDX-License-Identifier: Apache-2.0
// Open Job Description: a template of the specification 2023-09 with the extension TASK_CHUNKING, as JSON.
// https://github.com/OpenJobDescription/openjd-specifications/wiki/2023-09-Template-Schemas
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "farm/engine.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kNotice_s = 60;  // between TERM and KILL, for the frame in hand

Json script(const FarmPlan& plan, const std::string& task, std::int64_t time_s) {
  Json run{{"command", "sh"},
           {"args", {task_script_path(plan), task}},
           {"cancelation", {{"mode", "NOTIFY_THEN_TERMINATE"}, {"notifyPeriodInSeconds", kNotice_s}}}};
  if (time_s > 0) {
    run["timeout"] = time_s;
  }
  return {{"actions", {{"onRun", run}}}};
}

Json requirements(const FarmPlan& plan) {
  Json amounts = Json::array();
  if (plan.threads > 0) {
    amounts.push_back({{"name", "amount.worker.vcpu"}, {"min", plan.threads}});
  }
  amounts.push_back({{"name", "amount.worker.memory"}, {"min", std::max<std::uint64_t>(plan.memory_mib, 1)}});
  return {{"amounts", amounts}};
}

// Chunks of frames are the engine's tasks; it may put several of them into one, and then says so as "3-5".
std::map<std::string, std::string> files(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  if (task_script_path(plan).find("{{") != std::string::npos) {
    throw Error(ErrorKind::input, plan.run_folder, "'{{' begins an expression in Open Job Description's templates",
                "choose another output folder");
  }
  Json steps = Json::array();
  std::string before;
  if (!chunks.empty()) {
    before = "Chunks";
    steps.push_back({{"name", before},
                     {"parameterSpace",
                      {{"taskParameterDefinitions",
                        Json::array({{{"name", "Chunk"},
                                      {"type", "CHUNK[INT]"},
                                      {"range", "{{Param.Chunks}}"},
                                      {"chunks", {{"defaultTaskCount", 1}, {"rangeConstraint", "CONTIGUOUS"}}}}})}}},
                     {"script", script(plan, "{{Task.Param.Chunk}}", plan.time_s)},
                     {"hostRequirements", requirements(plan)}});
  }
  for (const std::string& task : tasks_after_chunks(plan)) {
    Json step{{"name", task},
              {"script", script(plan, task, time_after_chunks_s(plan))},
              {"hostRequirements", requirements(plan)}};
    if (!before.empty()) {
      step["dependencies"] = Json::array({{{"dependsOn", before}}});
    }
    steps.push_back(step);
    before = task;
  }
  Json job{{"specificationVersion", "jobtemplate-2023-09"}, {"extensions", {"TASK_CHUNKING"}}, {"name", plan.name}};
  if (!chunks.empty()) {
    job["parameterDefinitions"] =
        Json::array({{{"name", "Chunks"}, {"type", "STRING"}, {"default", chunk_list(chunks)}}});
  }
  job["steps"] = steps;
  return {{"template.json", job.dump(2) + "\n"}};
}

// The reference implementation, on this machine. Others take the template by their own means.
std::string submit(const FarmPlan& plan) {
  return "openjd run " + shell_word(plan.folder + "/template.json") + " --step " +
         shell_word(tasks_after_chunks(plan).back()) + " --run-dependencies";
}

// An engine that ends a job at the first task that fails would try nothing again.
std::string again(const FarmPlan& plan) {
  return fmt::format(R"(  tries=${{GAZETRACE_TRIES:-0}}
  export GAZETRACE_TRIES=$((tries + 1))
  [ "$tries" -lt {} ] && exec sh "$0" "$1"
)",
                     plan.retries);
}

}  // namespace

const FarmEngine kFarmEngine_openjd{files, submit, again, " --progress openjd", false, true};

}  // namespace gazetrace
