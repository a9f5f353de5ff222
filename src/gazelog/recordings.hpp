// SPDX-License-Identifier: Apache-2.0
// Files that hold several recordings, or several blocks of one. A reader notes at which line another one begins; one of
// them is then taken out by its number or its name.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "gazelog/table.hpp"

namespace gazetrace {

// Notes that what follows from `line` on belongs to the recording of that name, which may have begun above already. A
// file of more recordings than can be meant is refused: Error(input).
void begin_recording(RawGaze& raw, const std::string& name, std::int64_t line);
// The same for a block, which has no name and is always a new one.
void begin_block(RawGaze& raw, std::int64_t line);

// The columns of a table that together name the recording of each row, such as the participant and the recording.
class RecordingColumns {
 public:
  // `declared` is the column that the user names, in place of those that have one of `names`.
  RecordingColumns(const DelimitedTable& table, const std::string& declared,
                   std::initializer_list<std::string_view> names);

  [[nodiscard]] std::size_t needed_cells() const;
  // Returns whether another recording begins, or goes on, with this row. A row that names none belongs to that of the
  // row before.
  bool note(TableRows& rows, RawGaze& raw);

 private:
  std::vector<std::size_t> columns_;
  std::vector<std::string> current_;
};

// Counts what each recording holds, and leaves only the chosen one. A file of one recording is left as it is.
// Error(input) where `choice` is neither a number nor a name of those that there are.
void choose_recording(RawGaze& raw, const std::string& choice);

std::int64_t duration_ns(const GazeRecording& recording);  // what int64 cannot hold becomes its end
// Several recordings, of which the one that is meant has to be chosen; blocks of one recording need not be.
bool needs_a_choice(const RawGaze& raw);
// "3 recordings: 1 (5338 rows, 26.7 s), 2 (...), ...": without names, which may identify a person.
std::string recordings_in_words(const std::vector<GazeRecording>& recordings);

}  // namespace gazetrace
