// SPDX-License-Identifier: Apache-2.0
// What a step of processing is: one file in steps/, one line in steps.def; and what several of them need.
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

// Neighbouring usable samples [first, end) no farther apart than three median steps: what a filter may run over.
// Filters never see blinks and losses, and never reach over them.
struct FilterRun {
  std::size_t first = 0, end = 0;
};
std::vector<FilterRun> filter_runs(const GazeLog& log);

// Places as vectors that may be added and weighted: (u, v, 0), or the direction.
Vec3d place_of(const GazeSample& sample, GazeKind kind);
// Back again: a direction is made of unit length, and a place on a screen says whether it is on it.
void set_place(GazeSample& sample, GazeKind kind, const Vec3d& place);
void set_direction(GazeSample& sample, GazeKind kind, const ScreenAngles& screen, const Vec3d& direction);

}  // namespace gazetrace
