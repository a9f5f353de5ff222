// SPDX-License-Identifier: Apache-2.0
#include <array>

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
namespace {

template <KernelFeatures kFeatures>
constexpr NamedKernel named(const char* name) {
  return {name, kFeatures, PathKernel<kFeatures, DiffuseModel::burley>::run,
          PathKernel<kFeatures, DiffuseModel::lambert>::run, PathKernel<kFeatures, DiffuseModel::matte>::run};
}

constexpr KernelFeatures kPlain{};
constexpr KernelFeatures kTextured{.textures = true};
constexpr KernelFeatures kInstanced{.textures = true, .instances = true};
constexpr KernelFeatures kUnlayered{.textures = true, .instances = true, .emission = true, .extras = true};
constexpr KernelFeatures kAll{.textures = true, .instances = true, .emission = true, .extras = true, .layers = true};

// "unlayered" covers everything but materials with extensions.
constexpr std::array kKernels{named<kPlain>("plain"), named<kTextured>("textured"),
                              named<kInstanced>("textured, instanced"), named<kUnlayered>("unlayered"),
                              named<kAll>("all")};

constexpr bool covers(const KernelFeatures& kernel, const KernelFeatures& scene) {
  return (kernel.textures || !scene.textures) && (kernel.instances || !scene.instances) &&
         (kernel.emission || !scene.emission) && (kernel.extras || !scene.extras) && (kernel.layers || !scene.layers);
}

}  // namespace

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

KernelFeatures kernel_features(const SceneFeatures& features, const RenderScene& scene) {
  return {.textures = features.textures || features.normal_maps,
          .instances = !scene.instances.empty(),
          .emission = features.emissive_triangles || features.unlit,
          .extras = !scene.extras.empty(),
          .layers = features.layers.any()};
}

KernelList kernels() {
  return {kKernels.data(), kKernels.data() + kKernels.size()};
}

const NamedKernel& choose_kernel(const KernelFeatures& features, bool all) {
  for (const NamedKernel& kernel : kKernels) {
    if (!all && covers(kernel.features, features)) {
      return kernel;
    }
  }
  return kKernels.back();
}

}  // namespace gazetrace
