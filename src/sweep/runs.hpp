// SPDX-License-Identifier: Apache-2.0
// Measurements before anything is concluded from them: single renderings of the frames of a row.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/results.hpp"

namespace gazetrace {

struct SweepFrameRun {
  double time_s = 0;
  ScoreTable scores;  // of the whole frame only
};

// One rendering of all frames of a row.
struct SweepRun {
  double time_s = 0;  // mean time of a frame; what counts is said at ResultRow in gazetrace/results.hpp
  // Mean time of a frame for exposure, view and writing its pictures. Known only of the repeat whose pictures are kept.
  std::optional<double> output_s;
  double samples = 0, rays = 0, pixels = 0;  // sums over all frames
  double lost_samples = 0;                   // rejected rays and samples that were not finite
  // Peak memory of the process while the frames were rendered. It includes the scene, the state of the metrics and, if
  // the program keeps freed memory, what earlier frames of the row have freed.
  double peak_mib = 0;
  double trace_reconstruct_ms = 0;  // sum over all frames
  std::map<std::string, double> region_samples;
  ScoreTable scores;  // over the scored frames
  std::vector<SweepFrameRun> frames;
};

// A row of the results while it is being measured. Its frames know their gaze; times, scores and what follows from
// them are concluded from the runs at the end (conclude.hpp).
struct MeasuredRow : ResultRow {
  bool is_foveated = false;    // its samples go where gaze or a picture says
  double compared_pixels = 0;  // of all frames
  std::string png;             // pattern of its pictures, relative to the directory; empty: none
  std::vector<SweepRun> runs;  // by repeat
};

struct Measurements {
  std::vector<MeasuredRow> rows;
  std::vector<ResultReference> references;
  std::vector<std::string> notes;
  std::map<std::string, std::string> machines;  // by the label of the task; empty: measured by one process
};

}  // namespace gazetrace
