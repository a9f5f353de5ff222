// SPDX-License-Identifier: Apache-2.0
// Where what a pixel shows was seen before: motion vectors of camera, bodies and shapes.
#pragma once

#include <cstdint>

#include "gazetrace/camera.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// The view that a frame is compared with.
struct EarlierView {
  Camera camera;
  std::int64_t t_video_ns = 0;  // bodies and shapes are where they were then
};

// One entry a pixel, of the ray through its centre. Lens and shutter are left out: both cameras are pinholes in the
// middle of their frames' time. Where the ray misses everything, the entry is about its direction.
struct SurfaceMotion {
  ImageGray depth_m;            // along the view axis; +Inf for a miss
  ImageRgb normal;              // of the triangle, unit, towards the camera; zero for a miss
  Image<std::uint32_t> object;  // 1 + index into Scene::instances; 0: a miss
  Image<Vec2d> earlier_px;      // where the same point of the surface was: its centre's pixel (i, j) is at + 0.5.
                                // NaN: behind the earlier camera
  ImageGray earlier_depth_m;    // along the earlier view axis; +Inf for a miss
  ImageRgb earlier_normal;      // as `normal`, of the triangle as it was
};

// A point of the world in continuous pixel coordinates of a frame, and its depth along the view axis. Square pixels, as
// in ray generation.
class PixelProjection {
 public:
  PixelProjection(const Camera& camera, int width_px, int height_px);

  struct Place {
    Vec2d px;  // NaN where the point is not in front of a perspective camera
    double depth_m = 0;
  };
  [[nodiscard]] Place point(const Vec3d& p) const;
  [[nodiscard]] Vec2d direction(const Vec3d& d) const;  // of something infinitely far
  // Depth at which the ray through `other_px` meets the plane through the point at `px` and `depth_m` with this normal
  // (world space). NaN where it does not.
  [[nodiscard]] double depth_on_plane(const Vec2d& px, double depth_m, const Vec3d& normal,
                                      const Vec2d& other_px) const;
  [[nodiscard]] Vec3d toward(const Vec3d& p) const;  // from a point to the camera, unit

 private:
  bool perspective_ = true;
  Vec3d origin_, right_, up_, forward_;
  Vec2d center_px_;
  double step_ = 1;  // of one pixel: tangent (perspective) or metres
};

}  // namespace gazetrace
