// SPDX-License-Identifier: Apache-2.0
// What the neighbouring columns and rows of a table say about its gaze.
#pragma once

#include <string>
#include <vector>

#include "gazelog/columns.hpp"

namespace gazetrace {

// `columns` with z, where a column of that name stands beside x and y and the three are of unit length: directions.
GazeColumns with_z_beside(const GazeFile& file, const DelimitedTable& table, const GazeColumns& columns);

// Adds a fault where a combined gaze is the sum of both eyes' columns beside it.
void find_sum_of_eyes(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan, RawGaze& raw);

// Adds a fault where the columns beside those of the gaze say that they are the head's rotation or places in space.
void find_other_things(const DelimitedTable& table, const ColumnPlan& plan, RawGaze& raw);

// The column by which a table of one's own says that its gaze lies on the picture of a camera on the head; empty: none.
std::string sign_of_scene_camera(const DelimitedTable& table, const ColumnPlan& plan);

// The origin that a column of the first row names; automatic where there is none, or none that is known.
PositionOrigin origin_in_column(const GazeFile& file, const DelimitedTable& table, RawGaze& raw);

// The text of a row that has nothing else but a time, or that begins with MSG; empty for other rows. `time` becomes the
// column of its time.
std::string_view text_of_message(TableRows& rows, std::size_t& time);

// Rows of sensors other than the eye tracker, by a column that names the sensor: those of whose rows none has gaze.
class OtherSensors {
 public:
  OtherSensors(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan);
  bool is_other(TableRows& rows);
  [[nodiscard]] const std::string& name() const { return name_; }
  std::size_t left_out = 0;

 private:
  OptionalColumn column_;
  std::string name_;
  std::vector<std::string> others_;
};

// Whether the rows that count as valid have places. If those that count as lost have them instead, the column was
// read the wrong way round.
class ValidityTally {
 public:
  void add(std::string_view text, const RawSample& sample);
  [[nodiscard]] std::string reversed() const;  // the text that means a good sample; empty: the column was read right
  [[nodiscard]] std::string in_words(const std::string& column) const;

 private:
  struct Value {
    std::string text;
    bool is_good = false;
    std::size_t rows = 0, with_place = 0;
  };
  [[nodiscard]] const Value* value_with_places(bool is_good) const;
  std::vector<Value> values_;
  std::size_t last_ = 0;
};

}  // namespace gazetrace
