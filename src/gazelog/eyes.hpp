// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Makes one gaze of the rows of one time, as `log.conventions.eye` says, keeps both eyes in `log.eyes`, and notes
// in `log.conventions.eye_taken` which gaze was taken. The rows are ordered, and there is at most one of each eye at a
// time. Error(usage) for an eye that the log does not have.
void choose_eyes(GazeLog& log);

// How the samples of a log with both eyes relate to one of them.
struct ChosenEye {
  std::optional<Eye> eye;  // left or right: the samples are that eye's, by GazeSample::eye; empty: of both
  bool is_alone = false;   // ... and nothing but its rows: the other never stood in, nothing was processed
};
ChosenEye chosen_eye(const GazeLog& log);

}  // namespace gazetrace
