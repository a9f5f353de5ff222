// SPDX-License-Identifier: Apache-2.0
// The meaning of a gaze log's numbers: units, origins, axes, marks of missing values, the eye, the display. Each is
// kept with the evidence from which it was concluded. `interpret` (gaze_raw.hpp) turns the numbers of a file into a
// gaze log under such conventions. Where one of them is in doubt, the same numbers can be read again under another.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// scene_camera: u, v are fractions of the picture of a camera on the head. That is no place on a display: such a log
// can be inspected and converted, but nothing can be rendered with it.
enum class GazeKind : std::uint8_t { screen, direction, scene_camera };
enum class GazeValidity : std::uint8_t { ok, low_confidence, blink, lost, off_screen, interpolated };
enum class Eye : std::uint8_t { left, right, cyclopean };

// The kind of recording device. The constants of a method are published for one of the two, and are never applied to
// data of the other.
enum class GazeDevice : std::uint8_t { desktop, head_mounted };

std::string_view to_string(GazeKind kind);
std::string_view to_string(GazeValidity validity);
std::string_view to_string(Eye eye);
std::string_view to_string(GazeDevice device);

enum class TimeUnit { automatic, ns, us, ms, s };
// norm and height are PsychoPy's, from the center: norm runs from -1 to 1 along both axes, height is -0.5 to 0.5 of the
// display's height.
enum class PositionUnit { automatic, fraction, px, mm, cm, deg, unit_vector, norm, height, rad };
// Where (0, 0) is, and which way y grows: down from the top, up from the bottom and from the center. Fractions from the
// center run from -1 to 1. automatic: the center for degrees, and the top left for everything else.
enum class PositionOrigin { automatic, top_left, bottom_left, center };

// The axes of a log's directions, of the eyes' origins and of the head's pose. +y is up but in `cv` and `unreal`.
//   gl        +x right, -z forward, right-handed: OpenXR, glTF, and gazetrace itself
//   unity     +x right, +z forward, left-handed
//   sranipal  +x to the wearer's left, +z forward, right-handed: HTC's SDK, Tobii's glasses
//   cv        +x right, +y down, +z forward, right-handed: scene cameras
//   unreal    +x forward, +y right, +z up, left-handed
enum class GazeAxes { automatic, gl, unity, sranipal, cv, unreal };

std::string_view to_string(PositionUnit unit);
std::string_view to_string(PositionOrigin origin);
std::string_view to_string(GazeAxes axes);

// Treatment of stamps that do not grow: refused; sorted, where the last of equal ones is kept; equal ones in pairs
// stand half a step apart; a counter that overflowed goes on.
enum class UnorderedPolicy { error, sort, pairs, unwrap };

// Which gaze is taken of a log that has both eyes.
//   automatic  the log's own combined gaze where it has one, which may jump when an eye is lost. Else the mean; but
//              where the median vertical difference of the eyes is above 0.5 degrees, with a warning, the eye that has
//              more usable samples, or less noise where both have as many. While it is lost the other one stands in,
//              moved by the offset between them
//   left, right  that eye alone
//   mean       the mean of both eyes, by angle. While one eye is lost the other one is moved by half the offset between
//              them, which is interpolated over gaps of up to 75 ms and a running mean over longer ones
enum class EyeChoice { automatic, left, right, mean };

// The source of a conclusion, the most trusted first. Conclusions from statistics are guesses.
enum class Evidence : std::uint8_t { option, sidecar, header, format, statistics };
std::string_view to_string(Evidence evidence);

// A decision about a file that nothing states and its numbers leave open, or that is stated and that its own numbers
// speak against.
struct ReadingDoubt {
  std::string code;      // as GazeFinding::code
  std::string what;      // the question, or the fault
  std::string evidence;  // the figures
  std::string setting;   // the options that answer it, in back quotes
  bool is_open = true;   // nothing states it
  bool refuses = true;   // nothing but an inspection reads the file so
};

template <class Value>
struct Concluded {
  Value value{};
  Evidence evidence = Evidence::format;
  std::string detail = {};  // where it is stated, or the look of the numbers
};

// A camera with OpenCV's rational distortion model. `k` holds k1 k2 p1 p2 k3 k4 k5 k6; the focal lengths and the
// principal point are in pixels.
struct SceneLens {
  double fx = 1, fy = 1, cx = 0, cy = 0;
  std::array<double, 8> k{};
};

// The kind of a place's numbers.
enum class PlaceForm : std::uint8_t {
  position,  // x, y on a display or on a picture; or two angles, each measured along its axis of a flat display
  vector,    // x, y, z of a direction
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
  double unit_scale = 1;  // how many of `unit` a 1 in the file stands for: 100 where it counts metres and `unit` is cm
  Concluded<PositionOrigin> origin{PositionOrigin::automatic};
  Vec2d corner;                         // the file's x and y of the display's top left corner, subtracted first
  bool degrees_are_directions = false;  // degrees from the head, for which no display is needed
  bool off_screen_is_told = false;      // the log itself says which samples lie beside the display
  std::optional<SceneLens> lens;

  // Directions.
  Concluded<GazeAxes> axes{GazeAxes::automatic};
  std::optional<Concluded<bool>> x_is_turned;  // whether the x axis had been turned when the log was written

  // Faults of the log that the user states.
  bool swap_xy = false, flip_x = false, flip_y = false;
  // The number that stands for missing places, in the file's unit. -32768, and magnitudes from 1e7 on, always do.
  std::optional<double> missing_value;
  bool zero_is_missing = false;  // so is a place of exactly (0, 0)

  // The display, or the scene camera's picture, of which positions become fractions; and the geometry that the
  // interpreted log states.
  std::optional<Concluded<DisplayGeometry>> display;
  std::optional<DisplayGeometry> recording_geometry;

  UnorderedPolicy unordered = UnorderedPolicy::error;
  // Where the log has both eyes. Of a log that was interpreted, `eye_taken` says which gaze its samples are: "left",
  // "right", "mean" or "combined".
  EyeChoice eye = EyeChoice::automatic;
  enum class TakenEye : std::uint8_t { left, right, mean, combined };
  struct Taken {
    TakenEye eye;
    bool is_alone;  // the log has rows of that eye only
  };
  std::optional<Concluded<Taken>> eye_taken;

  Warnings warnings;  // about overruled statements and guesses
  std::vector<ReadingDoubt> doubts;
};

}  // namespace gazetrace
