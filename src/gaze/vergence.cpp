// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_vergence.hpp"

#include <cmath>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gazelog/screen_angles.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastPupilsMm = 30, kMostPupilsMm = 100;  // from less than small children have to more than anybody
constexpr Vergence kUnknown{kNan, kNan, kNan};

bool can_be_pupils(double distance_mm) {
  return distance_mm >= kLeastPupilsMm && distance_mm <= kMostPupilsMm;
}

// The median of what the log's own places of the eyes say, whatever axes they are in; 0 where it has none.
double stated_pupil_distance_mm(const GazeLog& log) {
  std::vector<double> distances;
  for (const EyeOrigins& o : log.origins) {
    const double distance = length(to_double(o.right_mm) - to_double(o.left_mm));
    if (can_be_pupils(distance)) {
      distances.push_back(distance);
    }
  }
  return distances.empty() ? 0 : lower_quantile(distances, 0.5);
}

// Helmholtz's angles: the plane of the eyes and of what they look at turns about the line through both eyes, and each
// eye turns within it. So eyes that look at one point differ by the angle between their lines of sight, and not in
// elevation.
double azimuth_deg(const Vec3d& d) {
  return std::atan2(d.x, std::hypot(d.y, d.z)) * kDegPerRad;
}

double elevation_deg(const Vec3d& d) {
  return std::atan2(d.y, -d.z) * kDegPerRad;
}

// From the middle between the eyes to the middle of the shortest line between the lines of sight.
double meeting_distance_mm(const Vec3d& left_mm, const Vec3d& right_mm, const Vec3d& a, const Vec3d& b) {
  const Vec3d between = right_mm - left_mm;
  const Vec3d normal = cross(a, b);
  const double square = dot(normal, normal);
  if (!(square > 0)) {
    return kNan;
  }
  const double along_left = dot(cross(between, b), normal) / square;
  const double along_right = dot(cross(between, a), normal) / square;
  if (!(along_left > 0 && along_right > 0)) {
    return kNan;
  }
  const Vec3d meeting = ((left_mm + a * along_left) + (right_mm + b * along_right)) * 0.5;
  return length(meeting - (left_mm + right_mm) * 0.5);
}

// Places on the plane of the screen, in millimetres from the eye between the eyes.
class ScreenPlane {
 public:
  explicit ScreenPlane(const GazeLog& log) : angles_(log) {
    if (log.recording_geometry) {
      distance_mm_ = 10 * log.recording_geometry->distance_cm;
    }
  }
  [[nodiscard]] bool known() const { return angles_.known_by_size() && distance_mm_ > 0; }
  [[nodiscard]] Vec3d at(const Vec3d& place) const {
    const Vec3d direction = angles_.direction(place.x, place.y);
    return direction * (distance_mm_ / -direction.z);
  }

 private:
  ScreenAngles angles_;
  double distance_mm_ = 0;
};

}  // namespace

Vergence vergence_of(const Vec3d& left_mm, const Vec3d& right_mm, const Vec3d& left_direction,
                     const Vec3d& right_direction) {
  return {azimuth_deg(left_direction) - azimuth_deg(right_direction),
          elevation_deg(left_direction) - elevation_deg(right_direction),
          meeting_distance_mm(left_mm, right_mm, left_direction, right_direction)};
}

VergenceOverTime measure_vergence(const GazeLog& log, const VergenceSettings& settings) {
  if (settings.pupil_distance_mm != 0 && !can_be_pupils(settings.pupil_distance_mm)) {
    throw Error(ErrorKind::usage, "`pupil-distance`", "must be 30 to 100 mm", "most adults have 50 to 75 mm");
  }
  VergenceOverTime result;
  if (!has_both_eyes(log)) {
    result.missing = "the log has one gaze for both eyes";
    return result;
  }
  if (log.kind == GazeKind::scene_camera) {
    result.missing = "places on the picture of a scene camera are no directions of the eyes";
    return result;
  }
  result.is_distance_stated = settings.pupil_distance_mm != 0;
  result.pupil_distance_mm = result.is_distance_stated ? settings.pupil_distance_mm : stated_pupil_distance_mm(log);
  const bool is_screen = log.kind == GazeKind::screen;
  const ScreenPlane plane(log);
  if (is_screen && !plane.known()) {
    result.missing = "the size and the distance of the screen are not known";
    return result;
  }
  if (is_screen && result.pupil_distance_mm == 0) {
    result.missing = "the distance between the pupils is not known: state it with `pupil-distance`, in millimetres";
    return result;
  }
  const Vec3d left_mm{-0.5 * result.pupil_distance_mm, 0, 0};
  const Vec3d right_mm{0.5 * result.pupil_distance_mm, 0, 0};
  result.samples.reserve(log.eyes.size());
  for (const BothEyes& eyes : log.eyes) {
    if (!is_usable(eyes.left.validity) || !is_usable(eyes.right.validity)) {
      result.samples.push_back(kUnknown);
    } else if (is_screen) {
      result.samples.push_back(
          vergence_of(left_mm, right_mm, plane.at(eyes.left.at) - left_mm, plane.at(eyes.right.at) - right_mm));
    } else {
      result.samples.push_back(vergence_of(left_mm, right_mm, eyes.left.at, eyes.right.at));
      if (result.pupil_distance_mm == 0) {
        result.samples.back().distance_mm = kNan;
      }
    }
  }
  return result;
}

}  // namespace gazetrace
