// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Makes one gaze of the rows of each time, as `log.conventions.eye` says, keeps both eyes in `log.eyes`, and notes in
// `log.conventions.eye_taken` which gaze was taken. The rows must be in order, with at most one row of each eye at a
// time. Throws Error(usage) for an eye that the log does not have.
void choose_eyes(GazeLog& log);

// How the samples of a log with both eyes relate to one of them.
struct ChosenEye {
  std::optional<Eye> eye;  // the eye whose samples they are, by GazeSample::eye; empty: both
  bool is_alone = false;   // the samples are its rows alone: the other eye never stood in, nothing was processed
};
ChosenEye chosen_eye(const GazeLog& log);

}  // namespace gazetrace
