// SPDX-License-Identifier: Apache-2.0
// Vergence: the angle between the lines of sight of the two eyes, and the distance at which they meet, in the
// coordinates of Helmholtz (Howard & Rogers, Perceiving in Depth, 2012). How far pupils are apart: Dodgson, Variation
// and extrema of human interpupillary distance, 2004.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Vergence of the eyes at one sample; NaN where it is unknown.
struct Vergence {
  // Azimuth of the left eye less that of the right, in degrees, in the plane of the eyes and of their target
  // (Helmholtz): the angle between lines of sight that meet, positive for eyes that converge, 0 for parallel ones.
  double horizontal_deg;
  // Elevation of the left eye less that of the right, in degrees: the error of the tracker, since eyes move up and down
  // together.
  double vertical_deg;
  // From the middle between the eyes to the point that is nearest to both lines of sight (the middle of the shortest
  // line between them); NaN where the lines do not meet in front of the eyes.
  double distance_mm;
};

struct VergenceSettings {
  // Between the pupils, 30 to 100 mm; 0: where the log states the places of the eyes, the median of theirs.
  double pupil_distance_mm = 0;
};

struct VergenceOverTime {
  std::vector<Vergence> samples;  // one for each sample of the log
  double pupil_distance_mm = 0;   // that was used; 0: none
  bool is_distance_stated = false;
  std::string missing;  // why there are no values, in words for people; empty: there are some
};

// Of a log of both eyes. Of *directions* the angles follow from the directions alone, and only the distance needs to
// know how far the pupils are apart. Of places on a *screen* the eyes are half of the pupils' distance to the left and
// to the right of where the screen's geometry has the eye, so that everything needs it, and the screen's size and
// distance. Without both eyes, or without needed data, `samples` is empty and `missing` says why. Error(usage) for a
// pupil distance out of range.
VergenceOverTime measure_vergence(const GazeLog& log, const VergenceSettings& settings);

// Of eyes at these places that look in these directions, which need not be normalised; -z is ahead, +x right, +y up.
Vergence vergence_of(const Vec3d& left_mm, const Vec3d& right_mm, const Vec3d& left_direction,
                     const Vec3d& right_direction);

}  // namespace gazetrace
