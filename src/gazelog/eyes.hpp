// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Makes one gaze of the rows of each time, as `log.conventions.eye` says, keeps both eyes in `log.eyes`, and notes in
// `log.conventions.eye_taken` which gaze was taken. The rows must be in order, with at most one row of each eye at a
// time. Throws Error(usage) for an eye that the log does not have.
void choose_eyes(GazeLog& log);

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

// The steps of choose_eyes, for logs whose rows are grouped while they are made, so that a long log of several eyes
// never holds a sample for each row.
void check_eye_choice(const GazeLog& log, const RowsOfEyes& rows);
// Makes one sample of the rows of each time, which is the log's own combined gaze where it has one, with both eyes
// beside it. The rows come in order; `log.samples` may be those rows themselves, and is complete after `finish`.
class RowGrouper {
 public:
  explicit RowGrouper(GazeLog& log) : log_(log) {}
  void add(const GazeSample& row);
  void finish();

 private:
  void close();

  GazeLog& log_;
  std::size_t count_ = 0;  // times that are done
  bool is_open_ = false;
  GazeSample first_;
  std::optional<GazeSample> own_;
  BothEyes eyes_;
};
void choose_grouped_eyes(GazeLog& log, const RowsOfEyes& rows);

// How the samples of a log with both eyes relate to one of them.
struct ChosenEye {
  std::optional<Eye> eye;  // the eye whose samples they are, by GazeSample::eye; empty: both
  bool is_alone = false;   // the samples are its rows alone: the other eye never stood in, nothing was processed
};
ChosenEye chosen_eye(const GazeLog& log);

}  // namespace gazetrace
