// SPDX-License-Identifier: Apache-2.0
// What was measured, a row an arm, in a CSV file that grows: a study that was stopped goes on where it was.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "gazetrace/compare.hpp"

namespace gazetrace::gain {

// The whole frame, and the bands of eccentricity after it.
inline constexpr std::size_t kColumns = 1 + kEccentricityBandsDeg.size();
std::string column_name(std::size_t column);  // "frame", "0-2.6", ...

enum class Metric : std::uint8_t { relmse, flip, jod };
inline constexpr std::size_t kMetrics = 3;
inline constexpr std::array<const char*, kMetrics> kMetricNames{"relmse", "flip", "fovvideovdp"};

using ByColumn = std::array<double, kColumns>;  // NaN: there are no such pixels, or it was not measured
inline constexpr ByColumn kNothing = [] {
  ByColumn nothing{};
  nothing.fill(std::numeric_limits<double>::quiet_NaN());
  return nothing;
}();

struct StageTimes {  // of a frame
  double plan_ms = 0, guides_ms = 0, trace_ms = 0, reconstruct_ms = 0, temporal_ms = 0;
  [[nodiscard]] double sum_ms() const { return plan_ms + guides_ms + trace_ms + reconstruct_ms + temporal_ms; }
};

// kind   setup: `arm` says how the scene's errors came about, "timed" how its times did: frame, budget, view, gazes,
//               metrics and the references' bytes. Rows that differ in these never share a file or a table; which
//               program measured them is for its user to know
//        floor: of the reference. `arm` "halves": one half of its files against the other; "own": the relative MSE that
//               its own noise adds to every picture's
//        score: an arm's errors at a gaze
//        time:  what an arm took in round `seed`; `gaze` is "-" where it does not matter
// arm    a sampling, "uniform X" (X times the budget), "low resolution", "in blocks", "paper" (regions with their
//        own counts), "foveal rate" (uniform with as many samples as paper has in the fovea)
struct Row {
  std::string kind, scene, arm, filter, gaze;
  double u = 0.5, v = 0.5;
  int seed = 0;
  double spp = 0;
  StageTimes time;
  ByColumn share = kNothing;  // of the frame's pixels
  std::array<ByColumn, kMetrics> score{kNothing, kNothing, kNothing};

  [[nodiscard]] std::string key() const;  // of what is measured once
};

// A last line without an end is left out. Error(input) with file:line. Empty where there is no such file.
std::vector<Row> read_rows(const std::string& path);

// Appends to a file, row by row.
class RowFile {
 public:
  explicit RowFile(std::string path);
  [[nodiscard]] bool has(const Row& row) const { return keys_.contains(row.key()); }
  // Error(usage) where the file holds rows of the scene that were made otherwise.
  void claim(const std::string& kind, const std::string& scene, const std::string& setup);
  void add(const Row& row);

 private:
  std::string path_;
  std::set<std::string> keys_;
  std::vector<Row> setups_;
};

}  // namespace gazetrace::gain
