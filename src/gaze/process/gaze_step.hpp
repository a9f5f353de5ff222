// SPDX-License-Identifier: Apache-2.0
// A step of processing is one file in steps/ and one line in steps.def. This header also declares what several steps
// need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gaze/angles.hpp"
#include "gazetrace/gaze_process.hpp"

namespace gazetrace {

struct GazeStepEntry {
  GazeStepInfo info;
  // Changes the log and says what it did.
  std::string (*apply)(GazeLog& log, const GazeStep& step);
};

// A run of usable samples [first, end) whose neighbours are no farther apart than three median steps. Filters work
// within such runs, so that they never see blinks and losses and never reach across them.
struct FilterRun {
  std::size_t first = 0, end = 0;
};
std::vector<FilterRun> filter_runs(const GazeLog& log);

// The places of samples as vectors that can be added and weighted: (u, v, 0), or the direction.
Vec3d place_of(const GazeSample& sample, GazeKind kind);
// Sets the place from such a vector: a direction is normalized, and a place on a screen gets the validity of being on
// it or not.
void set_place(GazeSample& sample, GazeKind kind, const Vec3d& place);
void set_direction(GazeSample& sample, GazeKind kind, const ScreenAngles& screen, const Vec3d& direction);

}  // namespace gazetrace
