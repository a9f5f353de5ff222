// SPDX-License-Identifier: Apache-2.0
// Motion vectors: where the surface point that a pixel shows is in another view, earlier or later, by the motion of the
// camera, of rigid bodies and of shapes. Joining frames uses them.
#pragma once

#include <cstdint>

#include "gazetrace/camera.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// The view that a frame is compared with.
struct OtherView {
  Camera camera;
  std::int64_t t_video_ns = 0;  // the time whose positions and shapes count
};

// What the ray through a pixel's centre hits, by the tracer's own numbers: a point that can be followed to any time and
// into any view without another ray.
struct PixelHit {
  std::uint32_t instance, geometry, primitive;
  float u, v;
  bool mirrors;  // its look changes sharply with the view: transmission, or a roughness below kMirrorRoughness
};
inline constexpr float kMirrorRoughness = 0.2F;  // of the material as a whole, whatever its texture says

// What the pixels of a frame see, one entry each, as SurfaceMotion finds it. They belong to the tracer that found them.
struct PixelHits {
  OtherView view;  // from where, and when
  Image<PixelHit> hits;
  ImageRgb position_m;  // from the view's camera, in world axes; zero for a miss
};

// Where the points that pixels see are at another time, in another view. One entry per pixel that sees them.
struct HitPlaces {
  Image<std::uint32_t> object;  // 1 + index into Scene::instances; 0: a miss
  Image<Vec2d> px;              // in continuous coordinates of the other view, whether or not something hides them
                                // there; the pixel's own centre where nothing has moved; NaN where it is not in front
  ImageRgb position_m;          // from the other view's camera, in world axes; zero for a miss
  ImageRgb moved_m;             // from the one time to the other, in the world
  Image<std::uint8_t> mirrors;  // as PixelHit
};

// One entry per pixel, found by the ray through its centre. Lens and shutter are left out: both cameras are pinholes in
// the middle of their frames' times. Where the ray misses everything, other_px is where its direction is.
struct SurfaceMotion {
  ImageGray depth_m;            // along the view axis; +Inf for a miss
  ImageRgb normal;              // of the triangle, unit, towards the camera; zero for a miss
  Image<std::uint32_t> object;  // 1 + index into Scene::instances; 0: a miss
  ImageRgb position_m;          // in the world; zero for a miss
  Image<Vec2d> other_px;        // where the same point of the surface is, in continuous coordinates (pixel centres at
                                // + 0.5); NaN where it is not in front of the other camera
  ImageGray other_depth_m;      // along the other view's axis; +Inf for a miss
  ImageRgb other_normal;        // as `normal`, of the triangle at the other time, towards the other camera
};

// Projects points of the world into continuous pixel coordinates of a frame, with their depth along the view axis.
// Pixels are square, as in ray generation.
class PixelProjection {
 public:
  PixelProjection(const Camera& camera, int width_px, int height_px);

  struct Place {
    Vec2d px;  // NaN where the point is not in front of a perspective camera
    double depth_m = 0;
  };
  [[nodiscard]] Place point(const Vec3d& p) const;
  // The pixel of something infinitely far away in direction `d`. NaN where that is not in front of the camera, and
  // always without perspective.
  [[nodiscard]] Vec2d direction(const Vec3d& d) const;
  // The depth at which the ray through `other_px` meets the plane through the point at `px` and `depth_m` with this
  // normal (world space). Infinite or NaN where the two are parallel, negative where they meet behind the camera.
  [[nodiscard]] double depth_on_plane(const Vec2d& px, double depth_m, const Vec3d& normal,
                                      const Vec2d& other_px) const;
  [[nodiscard]] Vec3d toward(const Vec3d& p) const;  // unit direction from a point to the camera

 private:
  bool perspective_ = true;
  Vec3d origin_, right_, up_, forward_;
  Vec2d center_px_;  // where the view axis meets the frame
  double step_ = 1;  // size of a pixel: as a tangent (perspective) or in metres
};

}  // namespace gazetrace
