// SPDX-License-Identifier: Apache-2.0
// PathTracer and PosedScene: a scene with its lights, its pose, and what is traced through it.
#include <memory>
#include <optional>

#include "gazetrace/trace.hpp"
#include "trace/guides/coverage.hpp"
#include "trace/guides/first_hits.hpp"
#include "trace/guides/guides.hpp"
#include "trace/guiding/learning_pass.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/motion/surface_motion.hpp"
#include "trace/trace_frame.hpp"

namespace gazetrace {

struct PathTracer::Impl {
  Impl(const Scene& source, const TracerOptions& tracer_options)
      : scene(&source),
        options(tracer_options),
        render_scene(source, tracer_options),
        lights(source, tracer_options.light_choice) {}

  // Puts the scene into a pose, unless it is in it: empty times are the pose at rest, in which it begins.
  void pose(const std::optional<ShutterTimes>& times) {
    if (is_posed && times == posed) {
      return;
    }
    is_posed = false;  // until it is done: an error leaves the scene between two poses
    render_scene.move_to(*scene, times);
    posed = times;
    is_posed = true;
  }

  [[nodiscard]] bool moves() const { return !(scene->motions.empty() && scene->deformations.empty()); }
  [[nodiscard]] const NamedKernel& kernel_variant() const { return choose_kernel(render_scene, options.all_features); }

  const Scene* scene;
  TracerOptions options;
  RenderScene render_scene;
  LightSampler lights;
  std::optional<ShutterTimes> posed;
  bool is_posed = true;
};

PathTracer::PathTracer(const Scene& scene, const TracerOptions& options)
    : impl_(std::make_unique<Impl>(scene, options)) {}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

bool PathTracer::moves() const {
  return impl_->moves();
}

PosedScene PathTracer::at(const ShutterTimes& times) {
  return {*impl_, times};
}

PosedScene PathTracer::at_rest() {
  return {*impl_, std::nullopt};
}

PosedScene::PosedScene(PathTracer::Impl& tracer, const std::optional<ShutterTimes>& times)
    : tracer_(&tracer), times_(times) {
  tracer_->pose(times_);
}

SparseFrame PosedScene::trace(const Camera& camera, std::int32_t frame, const SamplingMap& map,
                              const TraceSettings& settings) const {
  tracer_->pose(times_);
  const CameraRays rays(camera, map.height_px);
  const NamedKernel& variant = tracer_->kernel_variant();
  FrameContext context = make_frame_context(*tracer_->scene, tracer_->render_scene, tracer_->lights, rays, settings);
  context.learned = settings.learned.get();
  SparseFrame out = trace_frame(context, variant.run, frame, map, tracer_->options.threads);
  out.stats.kernel = variant.name;
  return out;
}

LightLearning PosedScene::learn_light(const Camera& camera, int width_px, int height_px,
                                      const TraceSettings& settings) const {
  tracer_->pose(times_);
  if (settings.light_sampling == LightSampling::light_only) {
    return {};
  }
  const CameraRays rays(camera, height_px);
  const FrameContext context =
      make_frame_context(*tracer_->scene, tracer_->render_scene, tracer_->lights, rays, settings);
  return gazetrace::learn_light(context, tracer_->kernel_variant().run, width_px, height_px, tracer_->options.threads);
}

Guides PosedScene::guides(const Camera& camera, int width_px, int height_px, const GuideSettings& settings) const {
  tracer_->pose(times_);
  return trace_guides(tracer_->render_scene, tracer_->lights, CameraRays(camera, height_px), width_px, height_px,
                      settings, tracer_->options.threads);
}

std::vector<RayHit> PosedScene::first_hits(const Camera& camera, int width_px, int height_px,
                                           const std::vector<Vec2d>& places_px) const {
  tracer_->pose(times_);
  return trace_first_hits(*tracer_->scene, tracer_->render_scene, CameraRays(camera, height_px), width_px, height_px,
                          places_px, tracer_->options.threads);
}

std::vector<Coverage> PosedScene::coverage(const Camera& camera, std::int32_t frame, int width_px, int height_px,
                                           const std::vector<SurfaceIds>& surfaces,
                                           const CoverageSettings& settings) const {
  tracer_->pose(times_);
  return trace_coverage(*tracer_->scene, tracer_->render_scene, CameraRays(camera, height_px), frame, width_px,
                        height_px, surfaces, settings, tracer_->options.threads);
}

SurfaceMotion PosedScene::surface_motion(const Camera& camera, int width_px, int height_px,
                                         const OtherView& other) const {
  tracer_->pose(times_);
  return trace_surface_motion(*tracer_->scene, tracer_->render_scene, camera, width_px, height_px, other,
                              tracer_->options.threads);
}

PixelHits PosedScene::pixel_hits(const OtherView& view, int width_px, int height_px) const {
  tracer_->pose(times_);
  return trace_pixel_hits(tracer_->render_scene, view, width_px, height_px, tracer_->moves(), tracer_->options.threads);
}

HitPlaces PosedScene::places_of(const PixelHits& seen, const OtherView& other) const {
  tracer_->pose(times_);
  return places_of_hits(*tracer_->scene, tracer_->render_scene, seen, other, tracer_->options.threads);
}

const Scene& PathTracer::scene() const {
  return *impl_->scene;
}

TracerMemory PathTracer::memory() const {
  return {impl_->render_scene.rays->bytes(), impl_->render_scene.build_s};
}

std::string PathTracer::ray_library() const {
  return impl_->render_scene.rays->library();
}

}  // namespace gazetrace
