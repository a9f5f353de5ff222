// SPDX-License-Identifier: Apache-2.0
// Whether a reading of a file makes sense of an eye. The importer, the doctor, `plan` and `render` ask it alike.
#pragma once

#include <optional>

#include "gazelog/eye_motion.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// The unit that numbers without one are most likely in.
struct UnitReading {
  PositionUnit unit = PositionUnit::automatic;
  std::string evidence;               // with the figures of the rivals
  std::optional<ReadingDoubt> doubt;  // where rivals are left
  bool is_plain = false;              // pixels of a display that is stated: as certain as a table of one's own can be
};
// `rows` as the file has them, but for marks of missing values; `display` as far as it is known.
UnitReading read_unit(const RawRows& rows, const RawGaze& raw, const DisplayGeometry& display);

// What the numbers leave open or speak against under conventions that are otherwise concluded; `display` is what is
// known of the display or of the scene camera's picture.
std::vector<ReadingDoubt> judge_reading(const RawGaze& raw, const Conventions& conventions,
                                        const DisplayGeometry& display);

// Whether a fault says that other rows or columns are the gaze: then these numbers leave nothing open.
bool are_other_numbers_meant(const RawGaze& raw);

// Empty where 90 % of the positions fit the unit and the origin under which they are read.
std::optional<ReadingDoubt> doubt_position_unit(const RawGaze& raw, const Conventions& conventions,
                                                const DisplayGeometry& display);

// What a log without samples but with events or a bare refusal says of itself: throws Error(input) with the question,
// its figures and the options that answer it.
[[noreturn]] void refuse_doubt(const RawGaze& raw, const ReadingDoubt& doubt, const GazeReadOptions& options);

// Takes the size of the display that holds for the rows that are read; where it changes between them, adds a fault.
void settle_display(RawGaze& raw);

// The display by which positions are converted: what the log states, overruled by what the user gave, with a warning
// where they differ. What the user gave becomes the geometry of the recording, `c.recording_geometry`.
std::optional<Concluded<DisplayGeometry>> conversion_display(const RawGaze& raw, const GazeReadOptions& options,
                                                             Conventions& c);

}  // namespace gazetrace
