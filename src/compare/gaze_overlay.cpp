// SPDX-License-Identifier: Apache-2.0
// Draws gaze and retinal regions over a picture. Borders have the same width everywhere, since the distance to a border
// in pixels is computed as the distance in degrees over the local degrees per pixel.
#include <algorithm>
#include <cmath>

#include "gazetrace/compare.hpp"

namespace gazetrace {
namespace {

// `distance` is that from the nearest line, in half widths of a line: pixels up to 1 become white, up to 2 black.
void ink(DisplayImage& picture, int x, int y, double distance) {
  if (!(distance <= 2)) {
    return;
  }
  const auto code = static_cast<std::uint8_t>(distance <= 1 ? 255 : 0);
  std::uint8_t* bytes = &picture.bytes[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) +
                                            static_cast<std::size_t>(x))];
  std::fill(bytes, bytes + 3, code);
}

}  // namespace

void draw_gaze(DisplayImage& picture, const PlanarView& view, const Vec2d& gaze_px, const RetinalRegions& regions) {
  constexpr double kLinesOfHeight = 1.0 / 900;  // half the width of a line, relative to the picture's height
  constexpr double kArm = 9;                    // length of the cross's arms, in half widths
  const double half_px = std::max(0.6, kLinesOfHeight * picture.height_px);
  const Vec3d gaze = view.direction(gaze_px.x, gaze_px.y);
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      const auto eccentricity = [&](double dx, double dy) {
        return eccentricity_deg(view, gaze, x + 0.5 + dx, y + 0.5 + dy);
      };
      const double here = eccentricity(0, 0);
      const double deg_per_px =
          std::hypot(eccentricity(0.5, 0) - eccentricity(-0.5, 0), eccentricity(0, 0.5) - eccentricity(0, -0.5));
      double nearest = HUGE_VAL;
      for (const double end_deg : regions.end_deg) {
        nearest = std::min(nearest, std::fabs(here - end_deg) / deg_per_px / half_px);
      }
      const double from_x = std::fabs(x + 0.5 - gaze_px.x) / half_px;
      const double from_y = std::fabs(y + 0.5 - gaze_px.y) / half_px;
      if (std::max(from_x, from_y) <= kArm + 1) {
        nearest = std::min({nearest, std::max(from_x, from_y - kArm + 1), std::max(from_y, from_x - kArm + 1)});
      }
      ink(picture, x, y, nearest);
    }
  }
}

}  // namespace gazetrace
