// SPDX-License-Identifier: Apache-2.0
// A density model on a frame: its normalization, the terms that multiply it (in the order that FoveationSettings
// states), and what it can be at most within a square of pixels, which blocks are chosen by.
#pragma once

#include "foveation/falloff.hpp"

namespace gazetrace {

class DensityField {
 public:
  // Keeps references to `view` and `context.contrast`, which must outlive it.
  DensityField(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction,
               const MapContext& context, DensityModel model);

  // At a point in continuous pixel coordinates, in [floor, 1].
  [[nodiscard]] double at(double x_px, double y_px) const;

  // Bounds of the density within a square of pixels: exact bounds for models of eccentricity alone that fall, or whose
  // turns are known (by the triangle inequality no point of the square is farther from its centre, in degrees, than its
  // half diagonal in the plane); for others the extremes over a few points, which smooth models hardly leave.
  struct Bounds {
    double least, most;
  };
  [[nodiscard]] Bounds within(int x_px, int y_px, int side_px) const;

 private:
  struct Seen {
    Vec3d direction;
    FalloffPlace place;
  };
  [[nodiscard]] Seen seen(double x_px, double y_px) const;
  [[nodiscard]] Vec2d meridian(const Vec3d& direction) const;
  // Before contrast and floor, with the cosine of the angle off the view's axis.
  [[nodiscard]] double density(const FalloffPlace& place, double cos_off_axis) const;
  [[nodiscard]] double limited(double density) const;

  const PlanarView* view_;
  const ImageGray* contrast_;
  DensityModel model_;
  Vec3d gaze_, right_, up_;  // of unit length
  Vec2d gaze_px_;
  double uncertainty_deg_, floor_;
  double step_deg_;  // most degrees that a pixel's side spans
  double per_cpd2_;  // density for a cut-off of 1 cpd where the view's axis meets it
  bool shrinks_;     // with the cosine: normalized to the display
  // Terms that are the same everywhere: on what the model asks for, and on what is left of that at the full rate.
  double velocity_ = 1, flight_ = 1;
};

}  // namespace gazetrace
