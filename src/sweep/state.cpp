// SPDX-License-Identifier: Apache-2.0
#include "sweep/state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/reconstruct.hpp"
#include "sweep/sealed_json.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "gazetrace-sweep-state-1";
constexpr const char* kStateFile = "/state.json";
constexpr const char* kOtherFolder = "give another `output` folder, or `restart` to measure all again";

// Numbers are read back to the bit. JSON has no infinity, which is written as a text, and no NaN, which is null. This
// differs from results.json, which other programs read: there both are null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : std::isnan(value) ? Json() : Json(value > 0 ? "inf" : "-inf");
}
double number(const Json& json) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (json.is_number()) {
    return json.get<double>();
  }
  return json == "inf" ? kInfinity : json == "-inf" ? -kInfinity : std::numeric_limits<double>::quiet_NaN();
}

Json json_of(const std::map<std::string, double>& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values) {
    json[name] = number(value);
  }
  return json;
}
std::map<std::string, double> values_of(const Json& json) {
  std::map<std::string, double> values;
  for (const auto& [name, value] : json.items()) {
    values[name] = number(value);
  }
  return values;
}

Json json_of(const ScoreTable& scores) {
  Json json = Json::object();
  for (const auto& [metric, parts] : scores) {
    json[metric] = json_of(parts);
  }
  return json;
}
ScoreTable table_of(const Json& json) {
  ScoreTable scores;
  for (const auto& [metric, parts] : json.items()) {
    scores[metric] = values_of(parts);
  }
  return scores;
}

Json json_of(const SweepRun& run) {
  Json frames = Json::array();
  for (const SweepFrameRun& frame : run.frames) {
    frames.push_back({{"time_s", frame.time_s}, {"scores", json_of(frame.scores)}});
  }
  return {{"time_s", run.time_s},
          {"output_s", run.output_s ? Json(*run.output_s) : Json()},
          {"samples", run.samples},
          {"rays", run.rays},
          {"pixels", run.pixels},
          {"lost_samples", run.lost_samples},
          {"peak_mib", run.peak_mib},
          {"trace_reconstruct_ms", run.trace_reconstruct_ms},
          {"region_samples", json_of(run.region_samples)},
          {"scores", json_of(run.scores)},
          {"frames", std::move(frames)}};
}
SweepRun run_of(const Json& json) {
  SweepRun run;
  run.time_s = json.at("time_s");
  if (!json.at("output_s").is_null()) {
    run.output_s = json.at("output_s").get<double>();
  }
  run.samples = json.at("samples");
  run.rays = json.at("rays");
  run.pixels = json.at("pixels");
  run.lost_samples = json.at("lost_samples");
  run.peak_mib = json.at("peak_mib");
  run.trace_reconstruct_ms = json.at("trace_reconstruct_ms");
  run.region_samples = values_of(json.at("region_samples"));
  run.scores = table_of(json.at("scores"));
  for (const Json& frame : json.at("frames")) {
    run.frames.push_back({frame.at("time_s"), table_of(frame.at("scores"))});
  }
  return run;
}

// Empty where there is no such file. A file that is there was written by the same build, and was whole when the sweep
// began.
template <class Read>
auto load(const std::string& path, const Read& read,
          const char* remedy = "call again, and its contents are measured again")
    -> std::optional<decltype(read(Json()))> {
  if (!fs::is_regular_file(path)) {
    return std::nullopt;
  }
  try {
    return read(Json::parse(read_text_file(path)));
  } catch (const Json::exception&) {
    throw Error(ErrorKind::input, path, "is damaged", remedy);
  }
}

// Empty where no row is denoised.
std::string denoiser_of(const SweepPlan& plan) {
  const auto denoises = [](const auto& one) { return one.pipeline.reconstruction.filter == "oidn"; };
  const bool any = std::any_of(plan.tests.begin(), plan.tests.end(), denoises) ||
                   std::any_of(plan.references.begin(), plan.references.end(), denoises);
  return any ? denoiser_description() : std::string();
}

}  // namespace

void claim_directory(const SweepPlan& plan, const std::string& directory, const std::string& machine) {
  const std::string path = directory + kStateFile;
  const std::vector<std::pair<const char*, std::string>> mine{
      {"format", kFormat}, {"build", build_digest()}, {"denoiser", denoiser_of(plan)}, {"machine", machine}};
  const auto read = [&] {
    return load(
        path,
        [&](const Json& json) {
          std::vector<std::string> values;
          values.reserve(mine.size());
          for (const auto& [what, value] : mine) {
            values.push_back(json.value(what, std::string()));
          }
          return values;
        },
        kOtherFolder);
  };
  auto found = read();
  if (!found) {
    Json json;
    for (const auto& [what, value] : mine) {
      json[what] = value;
    }
    write_text_atomically(path, json.dump(1) + "\n");
    found = read();  // another task may have claimed it at the same moment
  }
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const auto& [what, value] = mine[i];
    if ((*found)[i] != value) {
      throw Error(ErrorKind::input, directory,
                  fmt::format("holds measurements of another {} ('{}', this is '{}'), and the two do not mix", what,
                              (*found)[i], value),
                  kOtherFolder);
    }
  }
}

// A damaged state is thrown away like any other.
void clear_directory(const std::string& directory) {
  if (!fs::is_regular_file(directory + kStateFile)) {
    return;
  }
  for (const char* name :
       {"runs", "references", "frames", "state.json", "results.json", "results.csv", "methods.txt"}) {
    fs::remove_all(fs::path(directory) / name);
  }
}

std::optional<StoredRun> load_run(const std::string& path) {
  return load(path, [](const Json& json) {
    StoredRun run;
    run.task = json.value("task", std::string());
    run.machine = json.value("machine", std::string());
    run.png = json.at("png");
    run.region_cpu_ms = values_of(json.at("region_cpu_ms"));
    run.trace_ms = json.at("trace_ms");
    run.trace_cpu_ms = json.at("trace_cpu_ms");
    for (const auto& [gaze, one] : json.at("by_gaze").items()) {
      run.by_gaze[gaze] = run_of(one);
    }
    return run;
  });
}

void save_run(const std::string& path, const StoredRun& run) {
  Json by_gaze = Json::object();
  for (const auto& [gaze, one] : run.by_gaze) {
    by_gaze[gaze] = json_of(one);
  }
  save_sealed(path,
              Json({{"task", run.task},
                    {"machine", run.machine},
                    {"png", run.png},
                    {"region_cpu_ms", json_of(run.region_cpu_ms)},
                    {"trace_ms", run.trace_ms},
                    {"trace_cpu_ms", run.trace_cpu_ms},
                    {"by_gaze", std::move(by_gaze)}})
                  .dump(),
              run.files);
}

std::optional<ScoreTable> load_scores(const std::string& path) {
  return load(path, [](const Json& json) { return table_of(json.at("scores")); });
}
void save_scores(const std::string& path, const ScoreTable& scores) {
  save_sealed(path, Json({{"scores", json_of(scores)}}).dump(), {});
}

std::optional<double> load_exposure(const std::string& path, const std::string& digest) {
  const auto found = load(path, [&](const Json& json) {
    return json.at("digest") == digest ? std::optional<double>(json.at("ev").get<double>()) : std::nullopt;
  });
  return found.value_or(std::nullopt);
}
void save_exposure(const std::string& path, const std::string& digest, double ev, const WrittenFiles& pictures) {
  save_sealed(path, Json({{"digest", digest}, {"ev", ev}}).dump(), pictures);
}

std::optional<RateSearch> load_rate(const std::string& path) {
  return load(path, [](const Json& json) {
    RateSearch search;
    search.spp = json.at("spp");
    for (const Json& one : json.at("tried")) {
      search.tried.emplace_back(one.at("spp"), one.at("time_s"));
    }
    return search;
  });
}
void save_rate(const std::string& path, const RateSearch& search) {
  Json tried = Json::array();
  for (const auto& [spp, time_s] : search.tried) {
    tried.push_back({{"spp", spp}, {"time_s", time_s}});
  }
  save_sealed(path, Json({{"spp", search.spp}, {"tried", std::move(tried)}}).dump(), {});
}

}  // namespace gazetrace
