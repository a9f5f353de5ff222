// SPDX-License-Identifier: Apache-2.0
// Viewing geometry: where a pixel lies as seen from the eye.
//
// Two geometries meet in a frame. *The place of the eye* comes from the eye and the display (this header);
// *the view* comes from the scene camera (camera.hpp). Eccentricity uses the first, except for logs of gaze directions
// (head-mounted displays), where the two coincide and the camera's frustum is the view.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// A flat display that faces the viewer. Pixel coordinates are continuous, with the origin at the top left corner of the
// active area.
struct DisplayGeometry {
  int width_px = 0;
  int height_px = 0;
  double width_cm = 0;  // of the active area
  double height_cm = 0;
  double distance_cm = 0;  // eye to the plane of the display
  // Where the perpendicular from the eye meets the display, counted from the display's centre to the right and up.
  double eye_x_cm = 0;
  double eye_y_cm = 0;
  double luminance_cd_m2 = 0;  // of its white; 0: not stated
};

struct NamedDisplay {
  std::string name;
  std::string description;
  DisplayGeometry geometry;
};

// The presets that `gazetrace list displays` prints. "paper" is the display of the source paper: 3840 x 2160 pixels,
// watched from 60 cm.
const std::vector<NamedDisplay>& named_displays();
DisplayGeometry display_by_name(std::string_view name);  // Error(usage) with the known names

// Reads a display from a JSON object whose keys are the fields of DisplayGeometry; the eye's position and the luminance
// may be missing, "name" and "description" may be added. Error(input) for unknown keys and the errors of check_display
// refuses.
DisplayGeometry load_display(const std::string& path);

// A display of which only the size in pixels and the pixels per degree in its middle are known (x: horizontally, y:
// vertically). Only the ratio of size to distance matters, so it gets the size that it would have at 100 cm.
DisplayGeometry display_of_pixels_per_degree(int width_px, int height_px, const Vec2d& pixels_per_degree);

// Error(usage) that names the field when a size or the distance is missing, non-finite or not positive.
void check_display(const DisplayGeometry& display);

// Horizontal pixels per degree where the perpendicular from the eye meets the display.
double pixels_per_degree(const DisplayGeometry& display);

// Where the frame lies on the display, in display pixels. A default-constructed one stands for the whole display.
struct FrameRect {
  double x_px = 0, y_px = 0, width_px = 0, height_px = 0;
};

// Directions from the eye to the pixels of a frame, for any flat view: a display seen from the eye, or the image plane
// of a perspective camera. Pixel coordinates are continuous and those of the *frame*; directions are in the eye's frame
// (+x right, +y up, -z forward) and not normalised.
struct PlanarView {
  double left = 0, top = 0;         // x and y of the frame's top left corner, at distance 1
  double step_x = 0, step_y = 0;    // size of a frame pixel at distance 1, both positive
  int width_px = 0, height_px = 0;  // of the frame

  [[nodiscard]] Vec3d direction(double x_px, double y_px) const {
    return {left + step_x * x_px, top - step_y * y_px, -1.0};
  }
  // The inverse, for directions with z < 0; {NaN, NaN} for directions that never meet the plane.
  [[nodiscard]] Vec2d pixel(const Vec3d& direction) const;
};

// Error(usage) where the aspect ratios of frame and rectangle differ by more than half a pixel.
PlanarView view_of_display(const DisplayGeometry& display, const FrameRect& rect, int frame_width_px,
                           int frame_height_px);
// The view of a perspective camera with vertical field of view `yfov_rad` that fills the frame; pixels are square.
PlanarView view_of_perspective(double yfov_rad, int frame_width_px, int frame_height_px);

// Angle at the eye between the gaze direction and the centre of a pixel, in degrees, 0..180.
double eccentricity_deg(const PlanarView& view, const Vec3d& gaze_direction, double x_px, double y_px);

}  // namespace gazetrace
