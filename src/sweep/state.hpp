// SPDX-License-Identifier: Apache-2.0
// What a sweep has finished, in files that are there completely or not at all, so that a killed sweep goes on from
// them; see sealed_json.hpp for what is damaged later. They are the sweep's own: only the build that wrote them reads
// them. Results for others are in gazetrace/results.hpp.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/output.hpp"
#include "gazetrace/sweep.hpp"
#include "sweep/runs.hpp"

namespace gazetrace {

// A digest of the file that this code runs from: the program, or the library where that is a shared one.
std::string build_digest();
std::string machine_description();  // processor and number of threads

// Marks an empty folder as this build's, its denoiser's where the plan denoises, and that machine's; `machine` is
// kManyMachines where tasks share the folder. Error(input) where the folder holds work of another of these.
inline constexpr const char* kManyMachines = "tasks on any machine";
void claim_directory(const SweepPlan& plan, const std::string& directory, const std::string& machine);
// Removes what a sweep has left in the folder, and nothing else.
void clear_directory(const std::string& directory);

// One rendering, with a set of scores for each gaze that it was scored with. Loading gives nothing where it has not
// been finished.
struct StoredRun {
  std::string task, machine;  // where it was measured: "2/5" and machine_description(); empty: in one process
  std::string png;            // pattern relative to the sweep's folder
  WrittenFiles files;         // its pictures, by names relative to the sweep's folder
  std::map<std::string, double> region_cpu_ms;
  double trace_ms = 0, trace_cpu_ms = 0;
  std::map<std::string, SweepRun> by_gaze;
};
std::optional<StoredRun> load_run(const std::string& path);
void save_run(const std::string& path, const StoredRun& run);

std::optional<ScoreTable> load_scores(const std::string& path);
void save_scores(const std::string& path, const ScoreTable& scores);

// The exposure of a frame of a reference whose pictures are all there; empty unless it was stored under this digest.
std::optional<double> load_exposure(const std::string& path, const std::string& digest);
void save_exposure(const std::string& path, const std::string& digest, double ev, const WrittenFiles& pictures);

// The rates that were tried to find equal time, with their times, and the rate that was chosen.
struct RateSearch {
  double spp = 0;
  std::vector<std::pair<double, double>> tried;  // samples a pixel, seconds a frame
};
std::optional<RateSearch> load_rate(const std::string& path);
void save_rate(const std::string& path, const RateSearch& search);

}  // namespace gazetrace
