// SPDX-License-Identifier: Apache-2.0
// Three regions about the gaze, after "Foveated Path Tracing with Configurable Sampling and Block-Based Rendering".
//
//   fovea         e <= e_f        tau1 samples per pixel
//   intermediate  e_f < e <= e_i  tau2 samples per block of n x n pixels
//   periphery     e_i < e         tau3 samples per block of m x m pixels
//
// cone: e is the angle at the eye between gaze and pixel centre, by atan2. disc: pixels whose centre is within r of the
// gaze point, with eq. (1) of the paper, 2 d R tan(a/2) / S, taken as the diameter for a = 2 e (disc) or as the radius
// for a = e (disc_by_radius). Borders are inclusive.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "foveation/model.hpp"

namespace gazetrace {
namespace {

// Fills row[first..last], whose two ends are already classified. Right only where the class is monotone in between.
template <class Classify>
void fill_between(std::uint8_t* row, int first, std::uint8_t first_class, int last, std::uint8_t last_class,
                  const Classify& classify) {
  if (first_class == last_class) {
    std::memset(row + first, first_class, static_cast<std::size_t>(last - first + 1));
    return;
  }
  if (last - first == 1) {
    row[first] = first_class;
    row[last] = last_class;
    return;
  }
  const int middle = first + (last - first) / 2;
  const std::uint8_t middle_class = classify(middle);
  fill_between(row, first, first_class, middle, middle_class, classify);
  fill_between(row, middle, middle_class, last, last_class, classify);
}

// Fills a row in which the distance from the gaze has one extremum, at `turn_px` (continuous; NaN or infinite: none).
// On either side of it the class is monotone, so every border is found by bisection with the exact test.
template <class Classify>
void fill_row(std::uint8_t* row, int width, double turn_px, const Classify& classify) {
  const double before_turn = std::floor(turn_px - 0.5);  // the last pixel whose centre does not lie beyond the turn
  const int turn = std::isnan(before_turn) ? -1 : static_cast<int>(std::clamp(before_turn, -1.0, width - 1.0));
  if (turn >= 0) {
    fill_between(row, 0, classify(0), turn, classify(turn), classify);
  }
  if (turn < width - 1) {
    fill_between(row, turn + 1, classify(turn + 1), width - 1, classify(width - 1), classify);
  }
}

std::uint8_t region_of(double distance, const std::array<double, 2>& limits) {
  return distance <= limits[0] ? 0 : distance <= limits[1] ? 1 : 2;
}

void fill_cone(Image<std::uint8_t>& region, const std::array<double, 2>& limits_deg, const PlanarView& view,
               const Vec3d& gaze) {
  for (int y = 0; y < region.height_px; ++y) {
    // With X and Y the row's position on the plane at distance 1, cos e = (K + g_x X) / sqrt(M + X^2) where
    // K = g_y Y - g_z and M = Y^2 + 1. Its derivative vanishes only at X = g_x M / K.
    const double plane_y = view.direction(0, y + 0.5).y;
    const double plane_turn = gaze.x * (plane_y * plane_y + 1.0) / (gaze.y * plane_y - gaze.z);
    const auto classify = [&](int x) { return region_of(eccentricity_deg(view, gaze, x + 0.5, y + 0.5), limits_deg); };
    fill_row(&region(0, y), region.width_px, (plane_turn - view.left) / view.step_x, classify);
  }
}

void fill_disc(Image<std::uint8_t>& region, const std::array<double, 2>& radii_px, const PlanarView& view,
               const Vec3d& gaze) {
  const Vec2d center = view.pixel(gaze);
  if (!std::isfinite(center.x) || !std::isfinite(center.y)) {
    return;  // the gaze never meets the plane: all periphery
  }
  const std::array<double, 2> squares{radii_px[0] * radii_px[0], radii_px[1] * radii_px[1]};
  for (int y = 0; y < region.height_px; ++y) {
    const double dy = y + 0.5 - center.y;
    const auto classify = [&](int x) {
      const double dx = x + 0.5 - center.x;
      return region_of(dx * dx + dy * dy, squares);
    };
    fill_row(&region(0, y), region.width_px, center.x, classify);
  }
}

// Eq. (1) on the plane at distance 1.
double disc_radius(RegionShape shape, double eccentricity_deg) {
  const double e = eccentricity_deg * kRadPerDeg;
  return shape == RegionShape::disc ? std::tan(e) : 2 * std::tan(0.5 * e);
}

}  // namespace

Layout region_layout(const RegionSampling& regions, const PlanarView& view, const Vec3d& gaze_direction) {
  Layout layout;
  layout.regions = {{"fovea", 1, regions.samples[0], regions.unit},
                    {"intermediate", regions.blocks_px[0], regions.samples[1], regions.unit},
                    {"periphery", regions.blocks_px[1], regions.samples[2], regions.unit}};
  layout.region = Image<std::uint8_t>(view.width_px, view.height_px, 2);
  if (regions.shape == RegionShape::cone) {
    fill_cone(layout.region, regions.eccentricities_deg, view, gaze_direction);
  } else {
    std::array<double, 2> radii_px{};
    for (std::size_t i = 0; i < radii_px.size(); ++i) {
      radii_px[i] = disc_radius(regions.shape, regions.eccentricities_deg[i]) / view.step_x;
    }
    fill_disc(layout.region, radii_px, view, gaze_direction);
  }
  return layout;
}

}  // namespace gazetrace
