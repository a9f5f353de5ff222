// SPDX-License-Identifier: Apache-2.0
// farm.json: what is to be done, for those who look after it later.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/json_whole.hpp"
#include "farm/engine.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

NLOHMANN_JSON_SERIALIZE_ENUM(FarmKind, {{FarmKind::frames, "frames"}, {FarmKind::sweep, "sweep"}})

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Writer and reader visit the same members.
template <class Plan, class Visit>
void each_member(Plan& plan, const Visit& visit) {
  visit("kind", plan.kind);
  visit("name", plan.name);
  visit("engine", plan.engine);
  visit("program", plan.program);
  visit("container", plan.container);
  visit("job_file", plan.job_file);
  visit("filter", plan.filter);
  visit("denoiser", plan.denoiser);
  visit("folder", plan.folder);
  visit("run_folder", plan.run_folder);
  visit("run_name", plan.run_name);
  visit("work_folder", plan.work_folder);
  visit("chunks", plan.chunks);
  visit("samples", plan.samples);
  visit("files_per_frame", plan.files_per_frame);
  visit("threads", plan.threads);
  visit("retries", plan.retries);
  visit("memory_mib", plan.memory_mib);
  visit("time_s", plan.time_s);
  visit("then", plan.then);
  visit("confine", plan.confine);
}

template <class Refuse>
void check_chunks(const FarmPlan& plan, const Refuse& refuse) {
  for (const std::string& chunk : plan.kind == FarmKind::sweep ? std::vector<std::string>() : plan.chunks) {
    try {
      parse_frame_list(chunk);
    } catch (const Error&) {
      throw refuse("is damaged: '" + bounded(chunk, 40) + "' is no list of frames");
    }
  }
}

}  // namespace

std::string farm_plan_json(const FarmPlan& plan) {
  Json json;
  each_member(plan, [&](const char* name, const auto& value) { json[name] = value; });
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void check_farm_denoiser(const std::string& run_folder, const std::string& run_name, const std::string& filter,
                         const std::string& denoiser) {
  FarmPlan plan;
  try {
    plan = read_farm(run_folder);
  } catch (const Error&) {
    return;  // there is none that could be asked
  }
  if (plan.run_name != run_name || plan.filter.empty() || (plan.filter == filter && plan.denoiser == denoiser)) {
    return;
  }
  const auto words = [](const std::string& name, const std::string& by) {
    return "'" + name + "'" + (by.empty() ? "" : " by '" + by + "'");
  };
  throw Error(ErrorKind::input, plan.folder + "/farm.json",
              "the farm's frames are filtered with " + words(plan.filter, plan.denoiser) + ", and here it would be " +
                  words(filter, denoiser),
              "give this machine the same library and kind of processor, or call 'gazetrace farm' on one like it");
}

FarmPlan read_farm(const std::string& folder) {
  std::string path = (fs::path(folder) / "farm.json").string();
  if (!fs::exists(path)) {
    path = (fs::path(folder) / "farm" / "farm.json").string();
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, folder, "there is no farm in it (farm/farm.json)",
                "give the folder of the outputs of a job that 'gazetrace farm' was called for");
  }
  const auto refuse = [&](const std::string& what) {
    return Error(ErrorKind::input, path, what, "call 'gazetrace farm' again, which keeps finished work");
  };
  const Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) {
    throw refuse("is damaged: it is no JSON object");
  }
  FarmPlan plan;
  each_member(plan, [&](const char* name, auto& value) {
    const auto found = json.find(name);
    if (found == json.end()) {
      throw refuse(std::string("is not the plan of a farm of this version: it does not tell '") + name + "'");
    }
    try {
      read_json(*found, path, value);
    } catch (const Json::exception&) {
      throw refuse(std::string("is damaged: '") + name + "' has a value of another kind");
    }
  });
  if (Json(plan.kind) != json.at("kind")) {
    throw refuse("is damaged: chunks are of frames or sweep");
  }
  constexpr std::int64_t kMostTime_s = 10'000'000'000;  // of DurationNs
  constexpr std::uint64_t kMostMemory_mib = std::uint64_t{1} << 44U;
  if (plan.time_s < 0 || plan.time_s > kMostTime_s || plan.memory_mib > kMostMemory_mib || plan.threads < 0 ||
      plan.retries < 0 || plan.files_per_frame < 1) {
    throw refuse("is damaged: it has limits that no farm can have");
  }
  if (plan.chunks.empty() || plan.samples.size() != plan.chunks.size()) {
    throw refuse("is damaged: it does not tell the same of every chunk");
  }
  check_chunks(plan, refuse);
  farm_engine(plan.engine);
  std::error_code failed;
  const fs::path found = fs::canonical(path, failed).parent_path();
  std::error_code absent;
  if (!failed && !fs::equivalent(plan.folder, found, absent)) {
    plan.is_moved = true;
    plan.folder = found.string();
    plan.run_folder = found.parent_path().string();
  }
  return plan;
}

}  // namespace gazetrace
