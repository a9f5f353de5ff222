// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// How many rows there are of each eye.
struct RowsOfEyes {
  std::array<std::size_t, 3> of_eye{};  // in the order of Eye
  [[nodiscard]] std::size_t left() const { return of_eye[static_cast<std::size_t>(Eye::left)]; }
  [[nodiscard]] std::size_t right() const { return of_eye[static_cast<std::size_t>(Eye::right)]; }
  [[nodiscard]] std::size_t own() const { return of_eye[static_cast<std::size_t>(Eye::cyclopean)]; }
  [[nodiscard]] std::size_t kinds() const {
    return static_cast<std::size_t>(std::count_if(of_eye.begin(), of_eye.end(), [](std::size_t n) { return n > 0; }));
  }
};

// Throws Error(usage) for an eye that is chosen and that the log does not have.
void check_eye_choice(const GazeLog& log, const RowsOfEyes& rows);

// Makes one sample of the rows of each time, which come in order: of several eyes the log's own combined gaze where it
// has one, with both eyes beside it in `log.eyes`. Of rows of one eye at one time the last one stays. So a long log
// never holds a sample for each row.
class RowGrouper {
 public:
  RowGrouper(GazeLog& log, bool has_several, std::size_t times);
  void add(const GazeSample& row);
  void finish(UnorderedPolicy policy);

 private:
  void close();

  GazeLog& log_;
  bool has_several_;
  std::array<std::optional<GazeSample>, 3> of_eye_;  // at the time of `first_`
  std::optional<GazeSample> first_;
};

// Makes one gaze of both eyes, as `log.conventions.eye` says, and notes in `log.conventions.eye_taken` which gaze was
// taken.
void choose_eyes(GazeLog& log, const RowsOfEyes& rows);

// The place of a sample as a vector that can be added and weighted: (u, v, 0), or the direction.
Vec3d place_of(const GazeSample& sample, GazeKind kind);

// The gaze of a sample as that of one eye, and the other way round: what of a sample an eye's gaze replaces.
EyeGaze eye_gaze(const GazeSample& sample, GazeKind kind);
void take_eye(GazeSample& sample, const EyeGaze& eye, GazeKind kind);

// How the samples of a log with both eyes relate to one of them.
struct ChosenEye {
  std::optional<Eye> eye;  // the eye whose samples they are, by GazeSample::eye; empty: both
  bool is_alone = false;   // the samples are its rows alone: the other eye never stood in, nothing was processed
};
ChosenEye chosen_eye(const GazeLog& log);

}  // namespace gazetrace
