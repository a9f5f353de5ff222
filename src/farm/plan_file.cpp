// SPDX-License-Identifier: Apache-2.0
// farm.json: what is to be done, for those who look after it later.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/json_problem.hpp"
#include "farm/engine.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Writer and reader visit the same members.
template <class Plan, class Visit>
void each_member(Plan& plan, const Visit& visit) {
  visit("name", plan.name);
  visit("engine", plan.engine);
  visit("program", plan.program);
  visit("container", plan.container);
  visit("job_file", plan.job_file);
  visit("folder", plan.folder);
  visit("run_folder", plan.run_folder);
  visit("work_folder", plan.work_folder);
  visit("traces_first", plan.traces_first);
  visit("checkpoint", plan.checkpoint);
  visit("division", plan.division);
  visit("chunks", plan.chunks);
  visit("samples", plan.samples);
  visit("files_per_frame", plan.files_per_frame);
  visit("threads", plan.threads);
  visit("retries", plan.retries);
  visit("memory_mib", plan.memory_mib);
  visit("time_s", plan.time_s);
  visit("predicted_s", plan.predicted_s);
  visit("traced_bytes", plan.traced_bytes);
  visit("then", plan.then);
}

}  // namespace

std::string farm_plan_json(const FarmPlan& plan) {
  Json json;
  each_member(plan, [&](const char* name, const auto& value) { json[name] = value; });
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

FarmPlan read_farm(const std::string& folder) {
  std::string path = (fs::path(folder) / "farm.json").string();
  if (!fs::exists(path)) {
    path = (fs::path(folder) / "farm" / "farm.json").string();
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, folder, "there is no farm in it (farm/farm.json)",
                "give the folder of the outputs of a job that `farm` was called for");
  }
  try {
    const Json json = Json::parse(file);
    FarmPlan plan;
    each_member(plan, [&](const char* name, auto& value) { json.at(name).get_to(value); });
    return plan;
  } catch (const Json::exception& e) {
    throw Error(ErrorKind::input, path, "is not the plan of a farm: " + bounded(json_problem(e.what()), 200),
                "call `farm` again, which keeps finished frames");
  }
}

}  // namespace gazetrace
