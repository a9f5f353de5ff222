// SPDX-License-Identifier: Apache-2.0
// What the camera sees first, at full resolution: one ray a pixel instead of whole paths. Filters and reprojection are
// steered by it.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/image.hpp"
#include "gazetrace/material.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// What a camera ray ends on.
enum class SurfaceKind : std::uint8_t {
  miss,     // nothing: the environment
  unlit,    // shines and reflects nothing (KHR_materials_unlit)
  diffuse,  // what it reflects hardly depends on the view
  glossy,   // a clear lobe: metal or smooth, a clearcoat, or light that passes through
};

struct GuideSettings {
  int spp = 1;  // rays a pixel, 1..64: one goes through the centre, more are spread over the pixel
  // As TraceSettings::pixel_cone; on here, since one ray stands for the whole pixel where a path's samples would
  // average the texture themselves.
  double pixel_cone = 1;
  DiffuseModel diffuse = DiffuseModel::burley;
  int edge_rays = 0;  // more rays through pixels that an edge may cross, 0..64: Guides::edge_rays
};

// From pixels to places as the guides' rays go.
struct GuideCamera {
  bool perspective = true;
  Vec3f forward, right_step, up_step;  // steps: of one pixel, at depth 1 m (perspective) or anywhere
  // Of the point at continuous pixel coordinates from the frame's centre (x right, y down), relative to the eye, m.
  [[nodiscard]] Vec3f place(float x, float y, float depth_m) const {
    const Vec3f across = right_step * x - up_step * y;
    return perspective ? (forward + across) * depth_m : forward * depth_m + across;
  }
};

// One more ray through a pixel that an edge may cross.
struct EdgeRay {
  std::uint32_t pixel = 0;    // index into Guides' images
  std::uint32_t seen_by = 0;  // the pixel, this one or one of the eight about it, whose centre sees the same surface
  bool own_surface = false;   // none does: seen_by is an index into Guides::edge_surfaces
};

// What no pixel's centre near by sees; members as in Guides.
struct EdgeSurface {
  float x = 0, y = 0;  // continuous pixel coordinates from the frame's centre
  Vec3f albedo, normal, emission;
  float depth_m = 0;
  SurfaceKind kind = SurfaceKind::miss;
};

// One entry a pixel. Lens and shutter are left out: the camera is a pinhole in the middle of the frame's time, and so
// is everything that moves. Means over the pixel's rays; object, material and kind are those of most rays (of the first
// of them, where several come out equal). Alpha masks are cut out as in the tracer; blended surfaces are there or not
// by a hash of pixel and ray that is the same in every frame.
struct Guides {
  GuideCamera camera;
  // Share of even light from all around that the surface reflects to the camera (directional albedo of the
  // metallic-roughness lobes, multiple scattering included; extension lobes other than the index of refraction are left
  // out), at least kLeastAlbedo. Texture at the pixel's own level of detail. 1 for misses and unlit surfaces.
  ImageRgb albedo;
  ImageRgb normal;                // shading normal towards the camera, world space; zero on a miss
  ImageGray depth_m;              // along the view axis, mean over the hits; +Inf where all rays miss
  ImageRgb emission;              // radiance seen directly: surfaces that shine, unlit ones, the environment
  Image<std::uint32_t> object;    // 1 + index into Scene::instances; 0: miss
  Image<std::uint32_t> material;  // 1 + index into Scene::materials; 0: miss
  Image<SurfaceKind> kind;
  // GuideSettings::edge_rays for each pixel that differs from one of its four neighbours in object, material or kind,
  // in normal (bumps left out) by more than 25 degrees, or leaves their plane, unless all of them see what its centre
  // sees; in the order of the pixels. The images do not hold them.
  std::vector<EdgeRay> edge_rays;
  std::vector<EdgeSurface> edge_surfaces;
};

// Albedos are divided by.
inline constexpr float kLeastAlbedo = 0.01F;

}  // namespace gazetrace
