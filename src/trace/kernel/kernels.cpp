// SPDX-License-Identifier: Apache-2.0
#include "trace/kernel/emission.hpp"
#include "trace/kernel/generate.hpp"
#include "trace/kernel/guided.hpp"
#include "trace/kernel/layers.hpp"
#include "trace/kernel/light_groups.hpp"
#include "trace/kernel/path_kernel.hpp"
#include "trace/kernel/scatter.hpp"
#include "trace/kernel/shade.hpp"
#include "trace/kernel/shadow.hpp"
#include "trace/kernel/sky.hpp"

namespace gazetrace {
FrameContext make_frame_context(const Scene& scene, const RenderScene& render_scene, const LightSampler& lights,
                                const CameraRays& camera, const TraceSettings& settings) {
  FrameContext context;
  context.source = &scene;
  context.scene = &render_scene;
  context.lights = &lights;
  context.camera = &camera;
  context.settings = settings;
  const SceneFeatures& features = render_scene.features;
  const bool light_found_by_chance = settings.light_sampling != LightSampling::light_only;
  // Emitters that move or deform are found by rays only, not by light samples.
  const bool lamps_found_by_chance = light_found_by_chance || !scene.motions.empty() || !scene.deformations.empty();
  context.last_ray_needs_surface = features.unlit || (lamps_found_by_chance && features.emissive_triangles);
  context.last_ray_finds_light =
      context.last_ray_needs_surface || (light_found_by_chance && scene.environment.present());
  context.shifts_hits = camera.has_lens() || camera.moves() || render_scene.blurs;
  return context;
}

const NamedKernel& choose_kernel(const RenderScene& scene, bool all) {
  static constexpr NamedKernel kUnlayered{"unlayered", PathKernel<false>::run};
  static constexpr NamedKernel kAll{"all", PathKernel<true>::run};
  return all || scene.features.layers.any() ? kAll : kUnlayered;
}

}  // namespace gazetrace
