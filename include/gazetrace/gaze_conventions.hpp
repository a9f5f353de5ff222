// SPDX-License-Identifier: Apache-2.0
// What the numbers of a gaze log mean: units, origins, axes, marks of missing values, the eye, the display. Each with
// the evidence from which it was concluded. `interpret` (gaze_raw.hpp) turns the numbers of a file into a gaze log
// under such conventions, and whoever doubts one of them can read the same numbers under others.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// scene_camera: u, v are fractions of the picture of a camera on the head. That is no place on a display: such a log
// can be looked at and converted, but not rendered with.
enum class GazeKind : std::uint8_t { screen, direction, scene_camera };
enum class GazeValidity : std::uint8_t { ok, low_confidence, blink, lost, off_screen, interpolated };
enum class Eye : std::uint8_t { left, right, cyclopean };

// What a log was recorded with. Methods publish their constants for one of both; data of one kind are never measured
// with the constants of the other.
enum class GazeDevice : std::uint8_t { desktop, head_mounted };

std::string_view to_string(GazeKind kind);
std::string_view to_string(GazeValidity validity);
std::string_view to_string(Eye eye);
std::string_view to_string(GazeDevice device);

enum class TimeUnit { automatic, ns, us, ms, s };
enum class PositionUnit { automatic, fraction, px, mm, cm, deg, unit_vector };
// Where (0, 0) is and which way y grows: down from the top, up from the bottom and the center. Fractions from the
// center count half the display, -1..1. automatic: the center for degrees, else top left.
enum class PositionOrigin { automatic, top_left, bottom_left, center };

// Axes in which a log writes directions and origins, and a head's pose. All have +y up but `cv`.
//   gl        +x right, -z forward, right-handed: OpenXR, glTF, and gazetrace itself
//   unity     +x right, +z forward, left-handed
//   sranipal  +x to the wearer's left, +z forward, right-handed: HTC's SDK, Tobii's glasses
//   cv        +x right, +y down, +z forward, right-handed: scene cameras
enum class GazeAxes { automatic, gl, unity, sranipal, cv };

std::string_view to_string(PositionUnit unit);
std::string_view to_string(PositionOrigin origin);
std::string_view to_string(GazeAxes axes);

enum class UnorderedPolicy { error, sort };

// Which gaze a binocular log gives.
//   automatic  the log's own combined gaze where it has one; else the mean, or, where the eyes differ vertically by
//              over 0.5 deg in the median, the best eye, with a warning. A combined gaze may jump when an eye is lost
//   left, right  that eye alone
//   mean       of both eyes, in angle. While one eye is lost the other stands in, moved by half the offset between
//              them: for up to 75 ms straight from the one before to the one after, else the running one
//   dominant   `dominant_eye`; while it is lost the other, moved by the offset
//   best       as dominant, with the eye that has more usable samples, or less noise where both have as many
enum class EyeChoice { automatic, left, right, mean, dominant, best };

// From what something was concluded, in the order of trust. statistics is a guess.
enum class Evidence : std::uint8_t { option, sidecar, header, format, statistics };
std::string_view to_string(Evidence evidence);

template <class Value>
struct Concluded {
  Value value{};
  Evidence evidence = Evidence::format;
  std::string detail = {};  // where it is said, or what was seen
};

// A camera with OpenCV's rational distortion model. `k` holds k1 k2 p1 p2 k3 k4 k5 k6; the focal lengths and the
// principal point are in pixels.
struct SceneLens {
  double fx = 1, fy = 1, cx = 0, cy = 0;
  std::array<double, 8> k{};
};

// How the numbers of a place are to be taken.
enum class PlaceForm : std::uint8_t {
  position,           // x, y on a display or on a picture; or two angles of a flat display, each by itself
  vector,             // x, y, z of a direction
  azimuth_elevation,  // degrees on the sphere: to the right, and up from the horizon
  lens_pixel,         // a pixel of a scene camera, which becomes a direction through `Conventions::lens`
};

struct Conventions {
  // Time. The exponent is the power of ten from the unit of the stamps to nanoseconds: 9 for seconds, 0 for ns.
  Concluded<std::string> time_column;  // empty: there is no name for it
  Concluded<int> time_exponent;

  // Places.
  PlaceForm form = PlaceForm::position;
  Concluded<std::string> position_columns;
  Concluded<PositionUnit> unit{PositionUnit::automatic};
  double unit_scale = 1;  // a number of the file counts so many of `unit`: 100 for metres and centimetres
  Concluded<PositionOrigin> origin{PositionOrigin::automatic};
  Vec2d corner;                         // the file's x and y of the display's top left corner, taken off first
  bool degrees_are_directions = false;  // degrees from the head, for which no display is needed
  bool off_screen_is_told = false;      // the log itself says which samples lie beside the display
  std::optional<SceneLens> lens;

  // Directions.
  Concluded<GazeAxes> axes{GazeAxes::automatic};
  std::optional<Concluded<bool>> x_is_turned;  // whether somebody turned the x axis before the log was written

  // What the user says is wrong with the log.
  bool swap_xy = false, flip_x = false, flip_y = false;
  // Numbers that stand for missing places, in the file's unit. -32768, and sizes from 1e7 on, always do.
  std::optional<double> missing_value;
  bool zero_is_missing = false;

  // The display, or the scene camera's picture, that turns positions into fractions; and the geometry that the log has
  // from then on.
  std::optional<Concluded<DisplayGeometry>> display;
  std::optional<DisplayGeometry> recording_geometry;

  UnorderedPolicy unordered = UnorderedPolicy::error;
  // Where the log has both eyes. Of a log that was interpreted, `eye_taken` says which gaze its samples are: "left",
  // "right", "mean" or "combined".
  EyeChoice eye = EyeChoice::automatic;
  std::optional<Eye> dominant_eye;
  enum class TakenEye : std::uint8_t { left, right, mean, combined };
  struct Taken {
    TakenEye eye = TakenEye::combined;
    bool is_alone = false;  // nothing but the rows of that eye
  };
  std::optional<Concluded<Taken>> eye_taken;

  Warnings warnings;  // of what was overruled, and of what had to be guessed
};

}  // namespace gazetrace
