// SPDX-License-Identifier: Apache-2.0
// From the numbers of a row to its sample. This is the only place where a unit, an origin or an axis changes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

// -32768 and magnitudes from 1e7 on are not a coordinate in any unit.
bool is_missing_marker(double coordinate);

// The file's x and y of the display's top left corner for the row of that index.
Vec2d corner_of(const RawGaze& raw, const Conventions& conventions, std::size_t row);

// The rows of a log of positions (of more than 200 000 every n-th) with x and y in `conventions.unit`: without the
// marks of missing values, counted from the display's corner, and with the axes in their order. Guesses are made from
// these.
RawRows measurable_rows(const RawGaze& raw, const Conventions& conventions);

Vec3d from_axes(const Vec3d& v, GazeAxes axes);

// The direction that a row holds, in the axes of the file; need not be of unit length, and is NaN where the row has
// none.
Vec3d vector_of(const RawSample& row, const Conventions& conventions);

// Whether rows become places on a display or on a picture, rather than directions.
bool are_positions(const Conventions& conventions);

// From positions in a unit to fractions of the display. Throws Error(input) where that needs a display that is not
// known, and Error(usage) for degrees that do not count from straight ahead.
class ToFractions {
 public:
  ToFractions(const Conventions& conventions, const std::string& place);
  [[nodiscard]] Vec2d operator()(const Vec2d& at) const;

 private:
  PositionUnit unit_;
  PositionOrigin origin_;
  Vec2d size_;
  DisplayGeometry display_;
};

// The samples of the rows, one by one and each from its row alone: neither sorted nor joined. Throws as ToFractions.
class RowSamples {
 public:
  RowSamples(const RawGaze& raw, const Conventions& conventions);
  [[nodiscard]] GazeKind kind() const;
  [[nodiscard]] GazeSample operator()(std::size_t row) const;

 private:
  void place_position(const RawSample& row, std::size_t i, GazeSample& sample) const;
  void place_degrees(const RawSample& row, std::size_t i, GazeSample& sample) const;
  void place_vector(const RawSample& row, GazeSample& sample) const;

  const RawGaze& raw_;
  const Conventions& c_;
  std::optional<ToFractions> to_fractions_;  // of positions
};

// The conclusions and their evidence in words for people: about the time, other facts of the file, the places, and the
// eye. These words are never parsed again.
std::vector<GazeFact> facts_in_words(const RawGaze& raw, const Conventions& conventions);

SceneLens load_scene_lens(const std::string& path);  // scene_camera.json; Error(input)

// The unit vector of a pixel, with +x right, +y down, +z forward. It is undistorted by fixed-point iteration, as in
// OpenCV.
Vec3d ray_of(const SceneLens& lens, const Vec2d& pixel);

}  // namespace gazetrace
