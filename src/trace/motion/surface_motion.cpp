// SPDX-License-Identifier: Apache-2.0
#include "trace/motion/surface_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "trace/guides/primary_rays.hpp"
#include "trace/scene/instance_transform.hpp"

namespace gazetrace {
namespace {

constexpr int kTilePx = 32;
static_assert(kTilePx * kTilePx == kBatchSize);
constexpr std::uint64_t kPlaceKey = 0x6d6f74696f6e21ULL;  // keeps alpha hashes apart from those of traced samples

// The state of an instance at the other time and now.
struct InstancePoses {
  Affine now, then;
  bool moved = false;
  std::vector<DeformedVertices> shape;  // at the other time, one per geometry of the mesh; empty: it was the same
};

// `with_shapes`: InstancePoses::shape is wanted.
InstancePoses poses_of(const Scene& scene, const RenderScene& render_scene, const ShadingInstance& instance,
                       std::int64_t t_ns, bool with_shapes, int threads) {
  InstancePoses poses;
  if (instance.scene_instance == kNoId) {
    return poses;
  }
  const Instance& source = scene.instances[instance.scene_instance];
  poses.now = {to_double(instance.axes[0]), to_double(instance.axes[1]), to_double(instance.axes[2]),
               to_double(instance.translation)};
  poses.then = poses.now;
  if (source.motion >= 0) {
    const Affine to_world =
        counted_from(render_scene.origin_m, scene.motions[static_cast<std::size_t>(source.motion)].to_world_at(t_ns));
    // Compared in the precision of rays, so that what stands still does so exactly.
    poses.moved = ray_transform(to_world) != ray_transform(poses.now);
    poses.then = poses.moved ? to_world : poses.now;
  }
  if (source.deformation >= 0) {
    const MeshPose pose = scene.deformations[static_cast<std::size_t>(source.deformation)].pose_at(t_ns);
    if (!render_scene.is_in_pose(instance.scene_instance, pose)) {
      poses.moved = true;
      const std::vector<Geometry>& geometries = scene.meshes[static_cast<std::size_t>(source.mesh)].geometries;
      for (std::size_t i = 0; with_shapes && i < geometries.size(); ++i) {
        poses.shape.push_back(deform(geometries[i], pose, TextureRef{}, threads));
      }
    }
  }
  return poses;
}

struct Corners {
  std::array<Vec3d, 3> now, then;
};

// In an orthographic view all rays have one direction, so that rays that miss see the same at every pixel. While both
// cameras look in the same direction, such a pixel keeps its own history.
bool one_sky(const Camera& a, const Camera& b) {
  const auto forward = [](const Camera& camera) { return rotate(camera.pose.orientation, {0, 0, -1}); };
  return a.projection.kind == ProjectionKind::orthographic && b.projection.kind == ProjectionKind::orthographic &&
         length(forward(a) - forward(b)) < 1e-9;
}

// Where what pixels see was at one other time, and where that is in another view.
class HitFollower {
 public:
  HitFollower(const Scene& scene, const RenderScene& render_scene, const OtherView& other, int width_px, int height_px,
              bool with_shapes, int threads)
      : scene_(scene),
        render_scene_(render_scene),
        view_(counted_from(render_scene.origin_m, other.camera), width_px, height_px) {
    for (const ShadingInstance& instance : render_scene.instances) {
      poses_.push_back(poses_of(scene, render_scene, instance, other.t_video_ns, with_shapes, threads));
    }
  }

  [[nodiscard]] const PixelProjection& view() const { return view_; }
  // Whether what was hit is where it is in the pose of the tracer.
  [[nodiscard]] bool stays(const PixelHit& hit) const { return hit.instance == kNoId || !poses_[hit.instance].moved; }

  // The corners of the triangle in the coordinates of the tracer, in double: in the pose of the tracer, and at the
  // other time.
  [[nodiscard]] Corners corners_of(const PixelHit& hit) const {
    const GeometryRecord& record = render_scene_.geometries[hit.geometry];
    const InstancePoses* poses = hit.instance == kNoId ? nullptr : &poses_[hit.instance];
    const ShadingTriangle& triangle = render_scene_.triangles[record.first_triangle + hit.primitive];
    Corners corners;
    for (std::size_t c = 0; c < 3; ++c) {
      corners.now[c] = to_double(triangle.position[c]);
      corners.then[c] = corners.now[c];
      if (poses != nullptr) {
        if (!poses->shape.empty()) {
          const Instance& source = scene_.instances[render_scene_.instances[hit.instance].scene_instance];
          const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(source.mesh)];
          const auto vertex = mesh.geometries[record.scene_geometry].triangles[hit.primitive][c];
          corners.then[c] = to_double(poses->shape[record.scene_geometry].positions[vertex]);
        }
        corners.now[c] = transform_point(poses->now, corners.now[c]);
        corners.then[c] = transform_point(poses->then, corners.then[c]);
      }
    }
    return corners;
  }

 private:
  const Scene& scene_;
  const RenderScene& render_scene_;
  PixelProjection view_;
  std::vector<InstancePoses> poses_;
};

Vec3d point_on(const std::array<Vec3d, 3>& corners, const PixelHit& hit) {
  const double u = static_cast<double>(hit.u);
  const double v = static_cast<double>(hit.v);
  return corners[0] * (1 - u - v) + corners[1] * u + corners[2] * v;
}

// In the pose of the tracer.
Vec3d point_of(const RenderScene& scene, const PixelHit& hit) {
  const ShadingTriangle& triangle = scene.triangles[scene.geometries[hit.geometry].first_triangle + hit.primitive];
  const Vec3d point = point_on(
      {to_double(triangle.position[0]), to_double(triangle.position[1]), to_double(triangle.position[2])}, hit);
  if (hit.instance == kNoId) {
    return point;
  }
  const ShadingInstance& instance = scene.instances[hit.instance];
  return transform_point({to_double(instance.axes[0]), to_double(instance.axes[1]), to_double(instance.axes[2]),
                          to_double(instance.translation)},
                         point);
}

std::uint32_t object_of(const RenderScene& scene, const PixelHit& hit) {
  const std::uint32_t of_instance = hit.instance == kNoId ? kNoId : scene.instances[hit.instance].scene_instance;
  return 1 + (of_instance == kNoId ? scene.geometries[hit.geometry].scene_instance : of_instance);
}

bool mirrors(const RenderScene& scene, const PixelHit& hit) {
  const ShadingTriangle& triangle = scene.triangles[scene.geometries[hit.geometry].first_triangle + hit.primitive];
  const std::uint32_t material = triangle.material();
  const LayeredMaterial* layers = scene.layered.of(material);
  return scene.materials[material].roughness < kMirrorRoughness || (layers != nullptr && layers->layers.transmission);
}

Vec2d center_of(std::size_t pixel, int width_px) {
  const auto width = static_cast<std::size_t>(width_px);
  return {static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5};
}

CameraRays::Ray ray_of(const CameraRays& rays, std::size_t pixel, int width_px, int height_px) {
  const auto width = static_cast<std::size_t>(width_px);
  return rays.ray(static_cast<float>(pixel % width) + 0.5F - 0.5F * static_cast<float>(width_px),
                  static_cast<float>(pixel / width) + 0.5F - 0.5F * static_cast<float>(height_px));
}

bool same_view(const Camera& a, const Camera& b) {
  return a.pose == b.pose && a.projection == b.projection;
}

// Where a miss is in another view.
Vec2d place_of_miss(const HitFollower& other, const CameraRays& rays, std::size_t pixel, const Camera& from,
                    const Camera& to, int width_px, int height_px) {
  if (same_view(from, to) || one_sky(from, to)) {
    return center_of(pixel, width_px);
  }
  return other.view().direction(to_double(ray_of(rays, pixel, width_px, height_px).direction));
}

struct Workspace {
  RayBatch rays;
  HitBatch hits;
  std::array<std::size_t, kBatchSize> pixel;
};

void trace_tile(const RenderScene& scene, const CameraRays& rays, int x0, int y0, Workspace& work, PixelHits& out) {
  const Vec3d eye_m = out.view.camera.pose.position_m - scene.origin_m;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < kBatchSize; ++i) {
    const auto [dx, dy] = place_on_curve(i);
    const int x = x0 + dx;
    const int y = y0 + dy;
    if (x >= out.sights.width_px || y >= out.sights.height_px) {
      continue;
    }
    // The same in every frame, so that a blended surface does not flicker.
    const auto alpha_key = static_cast<std::uint32_t>(
        hash64(kPlaceKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x))));
    work.pixel[count] = out.sights.index(x, y);
    put_camera_ray(ray_of(rays, work.pixel[count], out.sights.width_px, out.sights.height_px), alpha_key, count,
                   work.rays);
    ++count;
  }
  scene.rays->intersect(work.rays, static_cast<int>(count), RayShape::coherent_packet, work.hits);
  for (std::size_t k = 0; k < count; ++k) {
    const HitBatch& hits = work.hits;
    if (hits.geometry[k] == kNoId || hits.geometry[k] == kRejected) {
      continue;
    }
    PixelHit hit{kNoId, hits.geometry[k], hits.primitive[k], hits.u[k], hits.v[k]};
    if (hits.instance[k] != kNoId) {
      hit.instance = hits.instance[k] - scene.first_instance_id;
      hit.geometry += scene.instances[hit.instance].first_geometry;
    }
    if (!out.hits.empty()) {
      out.hits.pixels[work.pixel[k]] = hit;
    }
    out.sights.pixels[work.pixel[k]] = {to_float(point_of(scene, hit) - eye_m), object_of(scene, hit), true,
                                        mirrors(scene, hit)};
  }
}

// visit(pixel) for all of them.
template <class Visit>
void for_each_pixel_of(int width_px, int height_px, int threads, const Visit& visit) {
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    const auto width = static_cast<std::size_t>(width_px);
    for (std::size_t pixel = row * width; pixel < (row + 1) * width; ++pixel) {
      visit(pixel);
    }
  });
}

}  // namespace

PixelHits trace_pixel_hits(const RenderScene& scene, const OtherView& view, int width_px, int height_px,
                           bool with_triangles, int threads) {
  PixelHits out{view, Image<PixelSight>(width_px, height_px), {}};
  if (with_triangles) {
    out.hits = Image<PixelHit>(width_px, height_px, {kNoId, kNoId, 0, 0, 0});
  }
  const CameraRays rays(counted_from(scene.origin_m, view.camera), height_px);
  const int rows = (height_px + kTilePx - 1) / kTilePx;
  parallel_for(static_cast<std::size_t>(rows), threads, [&](std::size_t row) {
    const FlushDenormals flush;
    const auto work = std::make_unique<Workspace>();
    for (int x0 = 0; x0 < width_px; x0 += kTilePx) {
      trace_tile(scene, rays, x0, static_cast<int>(row) * kTilePx, *work, out);
    }
  });
  return out;
}

struct HitPlaces::Impl {
  std::shared_ptr<const RenderScene> scene;
  const PixelHits& seen;
  OtherView other;
  HitFollower then, before;  // at the other time, and when the pixels saw it
  CameraRays rays;
  bool same, moves;  // the view; anything in the scene from the one time to the other
};

HitPlaces::HitPlaces(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
HitPlaces::~HitPlaces() = default;
HitPlaces::HitPlaces(HitPlaces&&) noexcept = default;
HitPlaces& HitPlaces::operator=(HitPlaces&&) noexcept = default;

HitPlace HitPlaces::at(std::size_t pixel) const {
  const PixelHits& seen = impl_->seen;
  const OtherView& other = impl_->other;
  const PixelSight& sight = seen.sights.pixels[pixel];
  HitPlace out;
  if (!sight.is_hit) {
    out.px = place_of_miss(impl_->then, impl_->rays, pixel, seen.view.camera, other.camera, seen.sights.width_px,
                           seen.sights.height_px);
    return out;
  }
  const Vec3d& origin_m = impl_->scene->origin_m;
  const Vec3d before = seen.view.camera.pose.position_m - origin_m + to_double(sight.position_m);
  const PixelHit* const hit = impl_->moves ? &seen.hits.pixels[pixel] : nullptr;
  const bool still = hit == nullptr || (impl_->then.stays(*hit) && impl_->before.stays(*hit));
  const Vec3d then = still ? before : point_on(impl_->then.corners_of(*hit).then, *hit);
  out.object = sight.object;
  out.mirrors = sight.mirrors;
  out.px = still && impl_->same ? center_of(pixel, seen.sights.width_px) : impl_->then.view().point(then).px;
  out.position_m = to_float(then - (other.camera.pose.position_m - origin_m));
  out.moved_m = to_float(then - before);
  return out;
}

HitPlaces places_of_hits(const Scene& scene, const std::shared_ptr<const RenderScene>& render_scene,
                         const PixelHits& seen, const OtherView& other, int threads) {
  const int width_px = seen.sights.width_px;
  const int height_px = seen.sights.height_px;
  return HitPlaces(std::unique_ptr<const HitPlaces::Impl>(new HitPlaces::Impl{
      render_scene, seen, other, HitFollower(scene, *render_scene, other, width_px, height_px, true, threads),
      HitFollower(scene, *render_scene, seen.view, width_px, height_px, false, threads),
      CameraRays(seen.view.camera, height_px), same_view(seen.view.camera, other.camera),
      !seen.hits.empty() && seen.view.t_video_ns != other.t_video_ns}));
}

SurfaceMotion trace_surface_motion(const Scene& scene, const RenderScene& render_scene, const Camera& camera,
                                   int width_px, int height_px, const OtherView& other, int threads) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  SurfaceMotion out;
  out.depth_m = ImageGray(width_px, height_px, kFar);
  out.object = Image<std::uint32_t>(width_px, height_px);
  out.position_m = ImageRgb(width_px, height_px);
  out.other_px = Image<Vec2d>(width_px, height_px);
  out.other_depth_m = ImageGray(width_px, height_px, kFar);
  const PixelHits seen = trace_pixel_hits(render_scene, {camera, other.t_video_ns}, width_px, height_px, true, threads);
  const HitFollower follower(scene, render_scene, other, width_px, height_px, true, threads);
  const Camera here = counted_from(render_scene.origin_m, camera);
  const CameraRays rays(here, height_px);
  const PixelProjection view(here, width_px, height_px);
  const bool same = same_view(camera, other.camera);
  for_each_pixel_of(width_px, height_px, threads, [&](std::size_t pixel) {
    const PixelHit& hit = seen.hits.pixels[pixel];
    if (hit.geometry == kNoId) {
      out.other_px.pixels[pixel] = place_of_miss(follower, rays, pixel, camera, other.camera, width_px, height_px);
      return;
    }
    const Corners corners = follower.corners_of(hit);
    const Vec3d now = point_on(corners.now, hit);
    const Vec3d then = point_on(corners.then, hit);
    const PixelProjection::Place place = follower.view().point(then);
    out.object.pixels[pixel] = seen.sights.pixels[pixel].object;
    out.depth_m.pixels[pixel] = static_cast<float>(view.point(now).depth_m);
    out.position_m.pixels[pixel] = to_float(render_scene.origin_m + now);
    out.other_px.pixels[pixel] = same && follower.stays(hit) ? center_of(pixel, width_px) : place.px;
    out.other_depth_m.pixels[pixel] = static_cast<float>(place.depth_m);
  });
  return out;
}

}  // namespace gazetrace
