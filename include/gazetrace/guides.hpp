// SPDX-License-Identifier: Apache-2.0
// What the camera sees first, at full resolution: one ray a pixel instead of whole paths. Filters that need guides are
// steered by them.
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
  int spp = 1;  // rays a pixel, 1..64: a single one goes through the centre, more are spread over the pixel
  // As TraceSettings::pixel_cone. It is on here, since one ray stands for the whole pixel, while the many samples of a
  // traced pixel average its texture by themselves.
  double pixel_cone = 1;
  DiffuseModel diffuse = DiffuseModel::burley;
  int edge_rays = 0;  // further rays through each pixel that an edge may cross, 0..64: Guides::edge_rays
};

// From pixels to places, along the guides' rays.
struct GuideCamera {
  bool perspective = true;
  Vec3f forward, right_step, up_step;  // a step is one pixel wide, at depth 1 m (perspective) or at any depth
  // The place seen at continuous pixel coordinates from the frame's centre (x right, y down), relative to the eye, m.
  [[nodiscard]] Vec3f place(float x, float y, float depth_m) const {
    const Vec3f across = right_step * x - up_step * y;
    return perspective ? (forward + across) * depth_m : forward * depth_m + across;
  }
};

// A further ray through a pixel that an edge may cross.
struct EdgeRay {
  std::uint32_t pixel = 0;  // index into Guides' images
  // The pixel, this one or one of the eight around it, whose centre sees the same surface as the ray; where there is
  // none, own_surface is set and this is an index into Guides::edge_surfaces.
  std::uint32_t seen_by = 0;
  bool own_surface = false;
};

// A surface that only an edge ray sees, and no pixel's centre near by; members as in Guides.
struct EdgeSurface {
  float x = 0, y = 0;  // continuous pixel coordinates from the frame's centre
  Vec3f albedo, normal, emission;
  float depth_m = 0;
  SurfaceKind kind = SurfaceKind::miss;
};

// One entry a pixel. Lens and shutter are left out: the camera is a pinhole, and everything that moves is where it is
// in the middle of the frame's time. Values are means over the pixel's rays; object, material and kind are those of
// most rays, and on a tie those of the earliest ray. Alpha masks are cut out as in the tracer. Whether a ray meets a
// blended surface follows from a hash of pixel and ray that is the same in every frame.
struct Guides {
  GuideCamera camera;
  // The share of even light from all around that the surface reflects to the camera, at least kLeastAlbedo: the
  // directional albedo of the metallic-roughness lobes with multiple scattering. Of the material extensions only the
  // index of refraction is included. Texture is read at the pixel's own level of detail. 1 for misses and unlit
  // surfaces.
  ImageRgb albedo;
  ImageRgb normal;                // shading normal towards the camera, world space; zero on a miss
  ImageGray depth_m;              // along the view axis, mean over the hits; +Inf where all rays miss
  ImageRgb emission;              // radiance seen directly: of emitters, unlit surfaces and the environment
  Image<std::uint32_t> object;    // 1 + index into Scene::instances; 0: miss
  Image<std::uint32_t> material;  // 1 + index into Scene::materials; 0: miss
  Image<SurfaceKind> kind;
  // GuideSettings::edge_rays of them for each pixel that differs from one of its four neighbours: in object, material
  // or kind, by more than 25 degrees in normal (normal maps left out), or by leaving their plane. A pixel all of whose
  // edge rays see what its centre sees has none. They are in the order of the pixels, and not part of the images'
  // means.
  std::vector<EdgeRay> edge_rays;
  std::vector<EdgeSurface> edge_surfaces;
};

// Albedos are divided by, so that they must not come near 0.
inline constexpr float kLeastAlbedo = 0.01F;

}  // namespace gazetrace
