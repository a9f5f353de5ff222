// SPDX-License-Identifier: Apache-2.0
#include "trace/motion/surface_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
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

InstancePoses poses_of(const Scene& scene, const RenderScene& render_scene, const ShadingInstance& instance,
                       std::int64_t t_ns, int threads) {
  InstancePoses poses;
  if (instance.scene_instance == kNoId) {
    return poses;
  }
  const Instance& source = scene.instances[instance.scene_instance];
  poses.now = {to_double(instance.axes[0]), to_double(instance.axes[1]), to_double(instance.axes[2]),
               to_double(instance.translation)};
  poses.then = poses.now;
  if (source.motion >= 0) {
    const Affine to_world = scene.motions[static_cast<std::size_t>(source.motion)].to_world_at(t_ns);
    // Compared in the precision of rays, so that what stands still does so exactly.
    poses.moved = ray_transform(to_world) != ray_transform(poses.now);
    poses.then = poses.moved ? to_world : poses.now;
  }
  if (source.deformation >= 0) {
    const MeshPose pose = scene.deformations[static_cast<std::size_t>(source.deformation)].pose_at(t_ns);
    if (!render_scene.is_in_pose(instance.scene_instance, pose)) {
      poses.moved = true;
      for (const Geometry& geometry : scene.meshes[static_cast<std::size_t>(source.mesh)].geometries) {
        poses.shape.push_back(deform(geometry, pose, TextureRef{}, threads));
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

class MotionTracer {
 public:
  MotionTracer(const Scene& scene, const RenderScene& render_scene, const Camera& camera, int width_px, int height_px,
               const OtherView& other, int threads)
      : scene_(scene),
        render_scene_(render_scene),
        rays_(camera, height_px),
        view_(camera, width_px, height_px),
        other_view_(other.camera, width_px, height_px),
        same_view_(camera.pose == other.camera.pose && camera.projection == other.camera.projection),
        misses_stay_(same_view_ || one_sky(camera, other.camera)),
        width_px_(width_px),
        height_px_(height_px) {
    for (const ShadingInstance& instance : render_scene.instances) {
      poses_.push_back(poses_of(scene, render_scene, instance, other.t_video_ns, threads));
    }
  }

  struct Workspace {
    RayBatch rays;
    HitBatch hits;
    std::array<std::size_t, kBatchSize> pixel;
  };

  void trace_tile(int x0, int y0, Workspace& work, SurfaceMotion& out) const {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < kBatchSize; ++i) {
      const auto [dx, dy] = place_on_curve(i);
      const int x = x0 + dx;
      const int y = y0 + dy;
      if (x >= width_px_ || y >= height_px_) {
        continue;
      }
      const CameraRays::Ray ray = rays_.ray(static_cast<float>(x) + 0.5F - 0.5F * static_cast<float>(width_px_),
                                            static_cast<float>(y) + 0.5F - 0.5F * static_cast<float>(height_px_));
      // The same in every frame, so that a blended surface does not flicker.
      const auto alpha_key = static_cast<std::uint32_t>(
          hash64(kPlaceKey ^ (static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x))));
      put_camera_ray(ray, alpha_key, count, work.rays);
      work.pixel[count] = out.depth_m.index(x, y);
      ++count;
    }
    render_scene_.rays->intersect(work.rays, static_cast<int>(count), RayShape::coherent_packet, work.hits);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t geometry = work.hits.geometry[k];
      if (geometry == kNoId || geometry == kRejected) {
        store_miss(work, k, out);
      } else {
        store_hit(work, k, out);
      }
    }
  }

 private:
  [[nodiscard]] Vec2d center_of(std::size_t pixel) const {
    const auto width = static_cast<std::size_t>(width_px_);
    return {static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5};
  }

  void store_miss(const Workspace& work, std::size_t k, SurfaceMotion& out) const {
    const std::size_t pixel = work.pixel[k];
    out.other_px.pixels[pixel] =
        misses_stay_ ? center_of(pixel) : other_view_.direction({work.rays.dx[k], work.rays.dy[k], work.rays.dz[k]});
  }

  void store_hit(const Workspace& work, std::size_t k, SurfaceMotion& out) const {
    const std::size_t pixel = work.pixel[k];
    const HitBatch& hits = work.hits;
    std::uint32_t record = hits.geometry[k];
    const InstancePoses* poses = nullptr;
    std::uint32_t scene_instance = kNoId;
    if (hits.instance[k] != kNoId) {
      const std::size_t index = hits.instance[k] - render_scene_.first_instance_id;
      record += render_scene_.instances[index].first_geometry;
      scene_instance = render_scene_.instances[index].scene_instance;
      poses = &poses_[index];
    }
    const GeometryRecord& geometry = render_scene_.geometries[record];
    scene_instance = scene_instance == kNoId ? geometry.scene_instance : scene_instance;
    const Corners corners = corners_of(geometry, hits.primitive[k], poses);
    const double u = static_cast<double>(hits.u[k]);
    const double v = static_cast<double>(hits.v[k]);
    const auto at = [&](const std::array<Vec3d, 3>& c) { return c[0] * (1 - u - v) + c[1] * u + c[2] * v; };
    const auto facing = [](const std::array<Vec3d, 3>& c, const Vec3d& toward) {
      const Vec3d face = normalize(cross(c[1] - c[0], c[2] - c[0]));
      return to_float(dot(face, toward) < 0 ? -face : face);
    };
    const Vec3d now = at(corners.now);
    const Vec3d then = at(corners.then);
    const PixelProjection::Place place = other_view_.point(then);
    const bool still = same_view_ && (poses == nullptr || !poses->moved);
    out.object.pixels[pixel] = 1 + scene_instance;
    out.depth_m.pixels[pixel] = static_cast<float>(view_.point(now).depth_m);
    out.position_m.pixels[pixel] = to_float(now);
    out.normal.pixels[pixel] = facing(corners.now, view_.toward(now));
    out.other_px.pixels[pixel] = still ? center_of(pixel) : place.px;
    out.other_depth_m.pixels[pixel] = static_cast<float>(place.depth_m);
    out.other_normal.pixels[pixel] = facing(corners.then, other_view_.toward(then));
  }

  // The corners in world space, in double.
  [[nodiscard]] Corners corners_of(const GeometryRecord& record, std::uint32_t primitive,
                                   const InstancePoses* poses) const {
    const ShadingTriangle& triangle = render_scene_.triangles[record.first_triangle + primitive];
    Corners corners;
    for (std::size_t c = 0; c < 3; ++c) {
      corners.now[c] = to_double(triangle.position[c]);
      corners.then[c] = corners.now[c];
      if (poses != nullptr) {
        if (!poses->shape.empty()) {
          const auto vertex = geometry_of(record, *poses).triangles[primitive][c];
          corners.then[c] = to_double(poses->shape[record.scene_geometry].positions[vertex]);
        }
        corners.now[c] = transform_point(poses->now, corners.now[c]);
        corners.then[c] = transform_point(poses->then, corners.then[c]);
      }
    }
    return corners;
  }

  [[nodiscard]] const Geometry& geometry_of(const GeometryRecord& record, const InstancePoses& poses) const {
    const auto index = static_cast<std::size_t>(&poses - poses_.data());
    const Instance& source = scene_.instances[render_scene_.instances[index].scene_instance];
    return scene_.meshes[static_cast<std::size_t>(source.mesh)].geometries[record.scene_geometry];
  }

  const Scene& scene_;
  const RenderScene& render_scene_;
  CameraRays rays_;
  PixelProjection view_, other_view_;
  bool same_view_, misses_stay_;
  int width_px_, height_px_;
  std::vector<InstancePoses> poses_;
};

}  // namespace

SurfaceMotion trace_surface_motion(const Scene& scene, const RenderScene& render_scene, const Camera& camera,
                                   int width_px, int height_px, const OtherView& other, int threads) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  SurfaceMotion out;
  out.depth_m = ImageGray(width_px, height_px, kFar);
  out.normal = ImageRgb(width_px, height_px);
  out.object = Image<std::uint32_t>(width_px, height_px);
  out.position_m = ImageRgb(width_px, height_px);
  out.other_px = Image<Vec2d>(width_px, height_px);
  out.other_depth_m = ImageGray(width_px, height_px, kFar);
  out.other_normal = ImageRgb(width_px, height_px);
  const MotionTracer tracer(scene, render_scene, camera, width_px, height_px, other, threads);
  const int rows = (height_px + kTilePx - 1) / kTilePx;
  parallel_for(static_cast<std::size_t>(rows), threads, [&](std::size_t row) {
    const FlushDenormals flush;
    const auto work = std::make_unique<MotionTracer::Workspace>();
    for (int x0 = 0; x0 < width_px; x0 += kTilePx) {
      tracer.trace_tile(x0, static_cast<int>(row) * kTilePx, *work, out);
    }
  });
  return out;
}

}  // namespace gazetrace
