// SPDX-License-Identifier: Apache-2.0
// Whether a reading of a file makes sense of an eye. The importer, the doctor, `plan` and `render` ask it alike. An eye
// in degrees has saccades whose duration follows from their size, so how the numbers of a log move tells their unit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// The middle 90 % of a coordinate's usable values.
struct Extent {
  double low = 0, median = 0, high = 0;
  bool is_of_few = false;
  [[nodiscard]] double spread() const { return high - low; }
};

// The largest jumps between rests, in the unit of the numbers; medians of them.
struct Saccades {
  std::size_t count = 0;
  double amplitude = 0, duration_ms = 0;
};

struct EyeMotion {
  Extent x, y;
  double share_negative = 0;  // rows with a coordinate below 0
  std::size_t rows = 0;
  std::optional<Saccades> saccades;  // empty: there are too few, or the stamps are too far apart to see how long one is

  [[nodiscard]] double most() const;  // the largest magnitude of both extents
  // How many degrees one unit would be by the durations of the saccades (the main sequence: 21 ms and 2.2 ms a degree,
  // Bahill, Clark and Stark 1975); empty where that is not known.
  [[nodiscard]] std::optional<double> degrees_per_unit() const;
  // What an eye would do if a unit were so many degrees.
  [[nodiscard]] std::string if_degrees(double degrees) const;
  [[nodiscard]] std::string in_words() const;  // "90 % of x lie in 1 .. 2, of y in 3 .. 4"
};

// The extent of one coordinate; empty where no row is usable.
std::optional<Extent> extent_of(const RawRows& rows, double Vec3d::*coordinate);

// Of rows whose x and y are in one unit. Jumps are looked for in one eye, in the first rows of a long log.
std::optional<EyeMotion> measure_motion(const RawRows& rows, const RawGaze& raw);

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
