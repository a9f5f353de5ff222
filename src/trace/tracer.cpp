// SPDX-License-Identifier: Apache-2.0
// PathTracer and PosedScene: a scene with its lights, its pose, and what is traced through it.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "gazetrace/trace.hpp"
#include "trace/guides/coverage.hpp"
#include "trace/guides/first_hits.hpp"
#include "trace/guides/guides.hpp"
#include "trace/guiding/training_pass.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/motion/surface_motion.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/trace_frame.hpp"

namespace gazetrace {

namespace {

// A camera this far from the world's origin is traced in coordinates that count from a corner of the cell that it is
// in, since floats hold coordinates the finer the smaller they are: to 4e-6 m within a cell. Which cell follows from
// the view alone, so that a frame has the same bits whatever was rendered before it.
constexpr double kFar_m = 512;
constexpr double kCell_m = 64;

Vec3d nearest_corner(const Vec3d& p) {
  const auto corner = [](double x) { return std::round(x / kCell_m) * kCell_m; };
  const bool is_far = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > kFar_m;
  return is_far && is_finite(p) ? Vec3d{corner(p.x), corner(p.y), corner(p.z)} : Vec3d{};
}

Vec3d clamped(const Vec3d& p, const Vec3d& low, const Vec3d& high) {
  return {std::clamp(p.x, low.x, high.x), std::clamp(p.y, low.y, high.y), std::clamp(p.z, low.z, high.z)};
}

}  // namespace

struct PathTracer::Impl {
  Impl(const Scene& source, const TracerOptions& tracer_options) : scene(&source), options(tracer_options) {
    build({});
  }

  // Puts the scene into a pose, unless it is in it: empty times are the pose at rest, in which it begins.
  void pose(const std::optional<ShutterTimes>& times) {
    if (is_posed && times == posed) {
      return;
    }
    is_posed = false;  // until it is done: an error leaves the scene between two poses
    render_scene->move_to(*scene, times);
    posed = times;
    is_posed = true;
  }
  // The same for a view, which is returned in the coordinates in which the scene is then.
  Camera pose(const std::optional<ShutterTimes>& times, const Camera& camera) {
    const Vec3d origin_m = origin_for(camera.pose.position_m);
    if (render_scene == nullptr || !(origin_m == render_scene->origin_m)) {
      build(origin_m);
    }
    pose(times);
    return counted_from(origin_m, camera);
  }

  [[nodiscard]] bool moves() const { return !(scene->motions.empty() && scene->deformations.empty()); }
  [[nodiscard]] const NamedKernel& kernel_variant() const { return choose_kernel(*render_scene, options.all_features); }

  const Scene* scene;
  TracerOptions options;
  std::shared_ptr<RenderScene> render_scene;
  std::unique_ptr<LightSampler> lights;
  std::optional<ShutterTimes> posed;
  bool is_posed = true;

 private:
  void build(const Vec3d& origin_m) {
    lights.reset();
    render_scene.reset();  // first, since there may be no memory for two
    render_scene = std::make_shared<RenderScene>(*scene, options, origin_m);
    lights = std::make_unique<LightSampler>(*scene, options.light_choice, origin_m);
    posed.reset();
    is_posed = true;
  }

  // Of a camera that looks at a scene from far away, the scene is in fine coordinates, and not the camera.
  Vec3d origin_for(const Vec3d& eye_m) {
    if (nearest_corner(eye_m) == Vec3d{} || moves()) {
      return nearest_corner(eye_m);
    }
    if (!bounds) {
      bounds = summarize(*scene);
    }
    return bounds->bounds_min.x <= bounds->bounds_max.x
               ? nearest_corner(clamped(eye_m, bounds->bounds_min, bounds->bounds_max))
               : Vec3d{};
  }

  std::optional<SceneSummary> bounds;
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
  const CameraRays rays(tracer_->pose(times_, camera), map.height_px);
  const NamedKernel& variant = tracer_->kernel_variant();
  FrameContext context = make_frame_context(*tracer_->scene, *tracer_->render_scene, *tracer_->lights, rays, settings);
  context.guiding_field = settings.guiding_field.get();
  SparseFrame out = trace_frame(context, variant.run, frame, map, tracer_->options.threads);
  out.stats.kernel = variant.name;
  return out;
}

TrainedGuiding PosedScene::train_guiding(const Camera& camera, int width_px, int height_px,
                                         const TraceSettings& settings) const {
  if (settings.light_sampling == LightSampling::light_only) {
    return {};
  }
  const CameraRays rays(tracer_->pose(times_, camera), height_px);
  const FrameContext context =
      make_frame_context(*tracer_->scene, *tracer_->render_scene, *tracer_->lights, rays, settings);
  return gazetrace::train_guiding(context, tracer_->kernel_variant().run, width_px, height_px,
                                  tracer_->options.threads);
}

Guides PosedScene::guides(const Camera& camera, int width_px, int height_px, const GuideSettings& settings) const {
  const CameraRays rays(tracer_->pose(times_, camera), height_px);
  return trace_guides(*tracer_->render_scene, *tracer_->lights, rays, width_px, height_px, settings,
                      tracer_->options.threads);
}

std::vector<RayHit> PosedScene::first_hits(const Camera& camera, int width_px, int height_px,
                                           const std::vector<Vec2d>& places_px) const {
  const CameraRays rays(tracer_->pose(times_, camera), height_px);
  return trace_first_hits(*tracer_->scene, *tracer_->render_scene, rays, width_px, height_px, places_px,
                          tracer_->options.threads);
}

std::vector<Coverage> PosedScene::coverage(const Camera& camera, std::int32_t frame, int width_px, int height_px,
                                           const std::vector<SurfaceIds>& surfaces,
                                           const CoverageSettings& settings) const {
  const CameraRays rays(tracer_->pose(times_, camera), height_px);
  return trace_coverage(*tracer_->scene, *tracer_->render_scene, rays, frame, width_px, height_px, surfaces, settings,
                        tracer_->options.threads);
}

SurfaceMotion PosedScene::surface_motion(const Camera& camera, int width_px, int height_px,
                                         const OtherView& other) const {
  tracer_->pose(times_, camera);
  return trace_surface_motion(*tracer_->scene, *tracer_->render_scene, camera, width_px, height_px, other,
                              tracer_->options.threads);
}

PixelHits PosedScene::pixel_hits(const OtherView& view, int width_px, int height_px) const {
  tracer_->pose(times_, view.camera);
  return trace_pixel_hits(*tracer_->render_scene, view, width_px, height_px, tracer_->moves(),
                          tracer_->options.threads);
}

HitPlaces PosedScene::places_of(const PixelHits& seen, const OtherView& other) const {
  tracer_->pose(times_, seen.view.camera);
  return places_of_hits(*tracer_->scene, tracer_->render_scene, seen, other, tracer_->options.threads);
}

const Scene& PathTracer::scene() const {
  return *impl_->scene;
}

TracerMemory PathTracer::memory() const {
  return {impl_->render_scene->rays->bytes(), impl_->render_scene->build_s};
}

std::string PathTracer::ray_library() const {
  return impl_->render_scene->rays->library();
}

}  // namespace gazetrace
