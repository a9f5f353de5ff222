// SPDX-License-Identifier: Apache-2.0
// A density model applied to a frame: its normalization, and its bounds within a square of pixels, by which blocks are
// chosen.
#pragma once

#include "foveation/model.hpp"

namespace gazetrace {

class DensityField {
 public:
  // Keeps references to `view` and `context.density`, which must outlive it. A model that follows a picture must have
  // one.
  DensityField(const PlanarView& view, const Vec3d& gaze_direction, const MapContext& context, DensityModel model);

  // The density at a point in continuous pixel coordinates, in [floor, 1].
  [[nodiscard]] double at(double x_px, double y_px) const;

  // The density of a rectangle of pixels: that at its middle. Of a model that follows a picture, which need not be
  // smooth, it is the mean over the pixels.
  [[nodiscard]] double over(int x_px, int y_px, int x_end_px, int y_end_px) const;

  // Bounds of the density within a square of pixels. They hold strictly for models of eccentricity alone that fall, or
  // whose turns are known: by the triangle inequality no point of the square is farther from its centre, in degrees,
  // than half its diagonal in the plane. For other models they are the extremes over a few points, which smooth models
  // hardly exceed.
  struct Bounds {
    double least, most;
  };
  [[nodiscard]] Bounds within(int x_px, int y_px, int side_px) const;

 private:
  struct Seen {
    Vec3d direction;
    DensityPlace place;
  };
  [[nodiscard]] Seen seen(double x_px, double y_px) const;
  [[nodiscard]] Vec2d meridian(const Vec3d& direction) const;
  // The density before picture and floor; `cos_off_axis` is the cosine of the angle off the view's axis.
  [[nodiscard]] double density(const DensityPlace& place, double cos_off_axis) const;
  [[nodiscard]] double limited(double density) const;

  const PlanarView* view_;
  const ImageGray* picture_;      // nullptr: the model follows none
  double per_picture_value_ = 1;  // one over the picture's largest value
  DensityModel model_;
  Vec3d gaze_, right_, up_;  // of unit length
  Vec2d gaze_px_;
  double floor_;
  double step_deg_;  // the largest angle that a pixel's side spans
  double per_cpd2_;  // the density for a cut-off of 1 cycle per degree on the view's axis
  bool shrinks_;     // falls with cos^3 off the axis, since it is normalized to the display
};

}  // namespace gazetrace
