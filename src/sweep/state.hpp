// SPDX-License-Identifier: Apache-2.0
// What a sweep has finished, in files that are there completely or not at all: a killed sweep goes on from them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sweep/runs.hpp"

namespace gazetrace {

// Content digest of the file that this code runs from: the program, or the library where it is a shared one.
std::string build_digest();
std::string machine_description();  // processor and number of threads

// Error(input) where the folder holds work of another build or machine; marks an empty one as this build's.
void claim_directory(const std::string& directory);
// Removes what a sweep has left in the folder, and nothing else.
void clear_directory(const std::string& directory);

// One rendering, with one set of scores for each gaze it was scored for. Empty: not finished.
struct StoredRun {
  std::string png;  // pattern relative to the sweep's folder
  std::map<std::string, double> region_cpu_ms;
  double trace_ms = 0, trace_cpu_ms = 0;
  std::map<std::string, SweepRun> by_gaze;
};
std::optional<StoredRun> load_run(const std::string& path);
void save_run(const std::string& path, const StoredRun& run);

std::optional<ScoreTable> load_scores(const std::string& path);
void save_scores(const std::string& path, const ScoreTable& scores);

// Exposures of a finished reference; empty unless its digest is this one.
std::optional<std::map<std::int32_t, double>> load_exposures(const std::string& path, const std::string& digest);
void save_exposures(const std::string& path, const std::string& digest, const std::map<std::int32_t, double>& ev);

// Times that were tried for an equal-time rate, by samples a pixel, and the rate chosen.
struct RateSearch {
  double spp = 0;
  std::vector<std::pair<double, double>> tried;  // samples a pixel, seconds a frame
};
std::optional<RateSearch> load_rate(const std::string& path);
void save_rate(const std::string& path, const RateSearch& search);

}  // namespace gazetrace
