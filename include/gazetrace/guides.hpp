// SPDX-License-Identifier: Apache-2.0
// Feature buffers: first hits of the camera, at full resolution, found with a ray or a few per pixel instead of whole
// paths. They steer filters.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/image.hpp"
#include "gazetrace/material.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// The hit of a camera ray.
enum class SurfaceKind : std::uint8_t {
  miss,     // nothing: the environment
  unlit,    // emits and reflects nothing (KHR_materials_unlit)
  diffuse,  // its reflection hardly depends on the view
  glossy,   // has a marked lobe: metal (metalness above 0.5), smooth (roughness below 0.35), clearcoat or transmission
};

struct GuideSettings {
  int spp = 1;  // rays per pixel, 1..64: a single one goes through the centre, several are spread over the pixel
  // Width of a ray's cone in pixels, which chooses the level of detail of textures. One ray stands for the whole pixel
  // here, where the samples of paths average the texture themselves.
  double pixel_cone = 1;
  DiffuseModel diffuse = DiffuseModel::burley;
  int edge_rays = 0;  // further rays through each pixel that an edge may cross, 0..64: Guides::edge_rays
};

// The camera of the guides' rays: turns a pixel and its depth into a point in space. World axes.
struct GuideCamera {
  bool perspective = true;
  Vec3f forward;              // unit, along the view axis
  Vec3f right_step, up_step;  // one pixel to the right and up: at depth 1 m (perspective) or at any depth, in m
  Vec2f middle_px;            // the frame's middle from the view axis, x right and y down (Camera::middle_px)
  // The point (m, relative to the camera) at continuous pixel coordinates from the frame's centre, x right and y down.
  [[nodiscard]] Vec3f place(float x, float y, float depth_m) const {
    const Vec3f across = right_step * (x + middle_px.x) - up_step * (y + middle_px.y);
    return perspective ? (forward + across) * depth_m : forward * depth_m + across;
  }
};

// One of the further rays through a pixel that an edge may cross.
struct EdgeRay {
  std::uint32_t pixel = 0;    // index into Guides' images
  std::uint32_t seen_by = 0;  // the pixel, this one or one of the eight around it, whose centre sees the same surface
  bool own_surface = false;   // there is no such pixel: seen_by is an index into Guides::edge_surfaces
};

// A surface that an edge ray hits and that the centre of no pixel next to it sees; members as in Guides.
struct EdgeSurface {
  float x = 0, y = 0;  // continuous pixel coordinates from the frame's centre
  Vec3f albedo, normal, emission;
  float depth_m = 0;
  SurfaceKind kind = SurfaceKind::miss;
};

// One entry per pixel. Lens and shutter are left out: the camera is a pinhole, and it and everything that moves are
// where they are in the middle of the frame's time. Values are means over the pixel's rays; object, material and kind
// are those that most rays see (where several are equally frequent, the one that comes first). Alpha masks are cut out
// as in the tracer. Whether a ray hits a blended surface is decided by a hash of pixel and ray that is the same in
// every frame.
struct Guides {
  GuideCamera camera;
  int spp = 1;  // GuideSettings::spp, rays behind each pixel of the images
  // The share of uniform light from all around that the surface reflects to the camera: the directional albedo of the
  // metallic-roughness lobes, multiple scattering included. Of the extensions, only the index of refraction is
  // considered. At least kLeastAlbedo; 1 for misses and unlit surfaces. Textures are read at the level of detail that
  // GuideSettings::pixel_cone gives.
  ImageRgb albedo;
  ImageRgb normal;                // shading normal towards the camera, world space; zero on a miss
  ImageGray depth_m;              // along the view axis, mean over the hits; +Inf where all rays miss
  ImageRgb emission;              // radiance seen directly: emissive and unlit surfaces, the environment
  Image<std::uint32_t> object;    // 1 + index into Scene::instances; 0: miss
  Image<std::uint32_t> material;  // 1 + index into Scene::materials; 0: miss
  Image<SurfaceKind> kind;
  // GuideSettings::edge_rays rays for each pixel that an edge may cross: it differs from one of its four neighbours in
  // object, material or kind, or by more than 25 degrees in normal (bumps left out), or it is off the plane of two
  // opposite ones. Pixels whose rays all see the surface of the centre are left out. In the order of the pixels. The
  // images do not contain the hits of these rays.
  std::vector<EdgeRay> edge_rays;
  std::vector<EdgeSurface> edge_surfaces;
};

// Filters divide by the albedo, so it is never less than this.
inline constexpr float kLeastAlbedo = 0.01F;

}  // namespace gazetrace
