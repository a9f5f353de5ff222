// SPDX-License-Identifier: Apache-2.0
// How the numbers of a log move, in their own unit: an eye in degrees has saccades whose duration follows from their
// size.
#pragma once

#include <optional>
#include <string>

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

}  // namespace gazetrace
