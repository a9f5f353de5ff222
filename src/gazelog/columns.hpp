// SPDX-License-Identifier: Apache-2.0
// Decides what each column of a table holds, from its header and from what the user or a preset declares.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gazelog/table.hpp"

namespace gazetrace {

// The columns of one gaze, which is that of one eye or of both together.
struct GazeSource {
  Eye eye = Eye::cyclopean;  // unless the table has a column for it
  std::size_t x = 0, y = 0;
  OptionalColumn z, validity, confidence, pupil, openness;
  VectorColumns origin;
};

struct ColumnPlan {
  std::size_t time = 0;
  std::vector<GazeSource> sources;  // at least one
  OptionalColumn eye, frame;
  VectorColumns head_position, head_rotation;
  OptionalColumn head_w;  // missing: the rotation is Euler angles
  GazeKind kind = GazeKind::screen;
  bool x_grows_left = false;
  std::optional<int> time_exponent;  // empty: it is to be found by statistics
  PositionUnit unit = PositionUnit::automatic;
  Evidence unit_evidence = Evidence::header;
  std::string pupil_unit;
  Warnings warnings;

  [[nodiscard]] std::size_t needed_cells(const DelimitedTable& table) const;
};

// Throws Error(input) for columns that do not exist and for unknown units.
ColumnPlan plan_columns(const DelimitedTable& table, const GazeColumns& declared);

enum class ValidityStyle { any, names };  // names: only the names of GazeValidity, 0 and 1

std::optional<GazeValidity> validity_by_name(std::string_view text);  // "ok", "low_confidence", "blink", ...

// Reads the texts of a column as validities.
class ValidityReader {
 public:
  ValidityReader(const GazeColumns& columns, ValidityStyle style);
  // Empty where the text is not a validity.
  std::optional<GazeValidity> read(std::string_view text);
  [[nodiscard]] const std::vector<std::string>& seen() const { return seen_; }

 private:
  std::optional<GazeValidity> interpret(const std::string& text);

  ValidityStyle style_;
  std::int64_t mask_;
  std::vector<std::string> wanted_, seen_;
  std::string last_text_;
  bool has_last_ = false;
  std::optional<GazeValidity> last_;
};

// left, L, both, cyclopean, ...
std::optional<Eye> eye_from(std::string_view text);

// What the neighbouring columns and rows say about the gaze (table_evidence.cpp).

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
