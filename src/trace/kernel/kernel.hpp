// SPDX-License-Identifier: Apache-2.0
// The kernel's interface: traces one batch of paths, from camera rays to the radiance of each sample.
#pragma once

#include <cstdint>

#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "trace/guiding/guiding_field.hpp"
#include "trace/kernel/path_batch.hpp"
#include "trace/lights/light_sampling.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {

struct FrameContext {
  const Scene* source = nullptr;
  const RenderScene* scene = nullptr;
  const LightSampler* lights = nullptr;
  const CameraRays* camera = nullptr;
  TraceSettings settings;
  bool last_ray_finds_light = false;    // the ray after the last scattering event can still find light
  bool last_ray_needs_surface = false;  // it can find light on a surface, so visibility of the sky is not enough
  bool shifts_hits = false;             // samples may hit what the pinhole sees elsewhere in the frame
  const GuidingField* guiding_field = nullptr;  // where light arrives from; empty: directions follow the BSDF alone
  // Rays are traced one by one: in packets, which of two surfaces a ray hits on their common edge may depend on the
  // other rays.
  bool single_rays = false;
  bool records_bounces = false;     // Workspace::bounces are collected, for training
  RayRecorder* recorder = nullptr;  // for measurements only
};

FrameContext make_frame_context(const Scene& scene, const RenderScene& render_scene, const LightSampler& lights,
                                const CameraRays& camera, const TraceSettings& settings);

struct KernelCounts {
  std::uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0, rejected = 0;
  std::uint64_t backs = 0;  // camera rays that hit the back of a face whose material is not double-sided
};

// Traces the first `count` entries of workspace.samples into workspace.radiance (and guides).
using Kernel = void (*)(const FrameContext&, Workspace&, int count, KernelCounts&);

struct NamedKernel {
  const char* name;
  Kernel run;
};

// Without the code of materials with extensions where the scene has none; with `all`, or where it has some, the variant
// that covers everything. Leaving out other code (textures, instances, emission, vertex colors) gains less than 2 %.
const NamedKernel& choose_kernel(const RenderScene& scene, bool all);

}  // namespace gazetrace
