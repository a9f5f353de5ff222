// SPDX-License-Identifier: Apache-2.0
// Motion vectors: where the surface point that a pixel shows is in another view, earlier or later, by the motion of the
// camera, of rigid bodies and of shapes. Joining frames uses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include "gazetrace/camera.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// The view that a frame is compared with.
struct OtherView {
  Camera camera;
  std::int64_t t_video_ns = 0;  // the time whose positions and shapes count
};

// The hit of the ray through a pixel's centre, by the tracer's own numbers: a point that can be followed to any time
// without another ray.
struct PixelHit {
  std::uint32_t instance, geometry, primitive;
  float u, v;
};
// The surface seen there.
struct PixelSight {
  Vec3f position_m;          // from the view's camera, in world axes; zero for a miss
  std::uint32_t object = 0;  // 1 + index into Scene::instances; 0: a miss
  bool is_hit = false;
  bool mirrors = false;  // its look changes sharply with the view: transmission, or a roughness below kMirrorRoughness
};
inline constexpr float kMirrorRoughness = 0.2F;  // of the material as a whole, without its texture

// The surfaces that the pixels of a frame see, one entry each, as SurfaceMotion finds it. They belong to their tracer.
struct PixelHits {
  OtherView view;  // from where, and when
  Image<PixelSight> sights;
  Image<PixelHit> hits;  // empty where nothing in the scene moves
};

// Where the point that a pixel sees is at another time, in another view.
struct HitPlace {
  std::uint32_t object = 0;  // as PixelSight
  bool mirrors = false;
  Vec2d px;          // in continuous coordinates of the other view, whether or not something hides it there; the
                     // pixel's own centre where nothing has moved; NaN where it is not in front
  Vec3f position_m;  // from the other view's camera, in world axes; zero for a miss
  Vec3f moved_m;     // from the one time to the other, in the world
};

// Finds these places, while the scene stays in its pose. Keeps a reference to the pixels' surfaces.
class HitPlaces {
 public:
  struct Impl;
  explicit HitPlaces(std::unique_ptr<const Impl> impl);
  ~HitPlaces();
  HitPlaces(HitPlaces&&) noexcept;
  HitPlaces& operator=(HitPlaces&&) noexcept;

  // From several threads at once, too.
  [[nodiscard]] HitPlace at(std::size_t pixel) const;

 private:
  std::unique_ptr<const Impl> impl_;
};

// One entry per pixel, found by the ray through its centre. Lens and shutter are left out: both cameras are pinholes in
// the middle of their frames' times. Where the ray misses everything, other_px is where its direction is.
struct SurfaceMotion {
  ImageGray depth_m;            // along the view axis; +Inf for a miss
  Image<std::uint32_t> object;  // 1 + index into Scene::instances; 0: a miss
  ImageRgb position_m;          // in the world; zero for a miss
  Image<Vec2d> other_px;        // where the same point of the surface is, in continuous coordinates (pixel centres at
                                // + 0.5); NaN where it is not in front of the other camera
  ImageGray other_depth_m;      // along the other view's axis; +Inf for a miss
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
  [[nodiscard]] Place point(const Vec3d& p) const {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    const Vec3d way = p - origin_;
    const double depth = dot(way, forward_);
    const double scale = perspective_ ? step_ * depth : step_;
    if (perspective_ && !(depth > 0)) {
      return {{kNowhere, kNowhere}, depth};
    }
    return {{center_px_.x + dot(way, right_) / scale, center_px_.y - dot(way, up_) / scale}, depth};
  }
  // The pixel of something infinitely far away in direction `d`. NaN where that is not in front of the camera, and
  // always without perspective.
  [[nodiscard]] Vec2d direction(const Vec3d& d) const;

 private:
  bool perspective_ = true;
  Vec3d origin_, right_, up_, forward_;
  Vec2d center_px_;  // where the view axis meets the frame
  double step_ = 1;  // size of a pixel: as a tangent (perspective) or in metres
};

}  // namespace gazetrace
