// SPDX-License-Identifier: Apache-2.0
// Meshes that change their shape from frame to frame, and while the shutter is open.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.hpp"
#include "trace/scene/instance_transform.hpp"
#include "trace/scene/octahedral.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {
namespace {

// While the shutter is open, a vertex moves on straight lines between at most this many steps; fewer are taken where
// that keeps vertices within this fraction of the mesh's size from their true positions.
constexpr int kMostSteps = 16;
constexpr double kStraightness = 1e-3;
constexpr std::size_t kBlock = 2048;  // triangles that a thread takes at once

// One entry per geometry of a mesh.
using MeshShape = std::vector<DeformedVertices>;

MeshShape shape_of(const Scene& scene, const Mesh& mesh, const MeshPose& pose, int threads) {
  MeshShape shape;
  for (const Geometry& geometry : mesh.geometries) {
    if (geometry.triangles.empty()) {
      continue;
    }
    const Material& material = scene.materials[static_cast<std::size_t>(geometry.material)];
    shape.push_back(deform(geometry, pose, material.normal_texture, threads));
  }
  return shape;
}

// The pose at every step of the open shutter; a single one for an instantaneous exposure, and for the mesh at rest.
std::vector<MeshPose> poses_of(const Deformation& deformation, const std::optional<ShutterTimes>& at) {
  if (!at) {
    return {deformation.rest};
  }
  const ShutterTimes& times = *at;
  std::vector<MeshPose> poses;
  const int steps = times.close_ns > times.open_ns ? kMostSteps : 0;
  for (int i = 0; i <= steps; ++i) {
    poses.push_back(deformation.pose_at(times.open_ns + (times.close_ns - times.open_ns) * i / std::max(steps, 1)));
  }
  return poses;
}

double size_of(const MeshShape& shape) {
  Vec3d low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  Vec3d high = -low;
  for (const DeformedVertices& geometry : shape) {
    for (const Vec3f& p : geometry.positions) {
      low = {std::min<double>(low.x, p.x), std::min<double>(low.y, p.y), std::min<double>(low.z, p.z)};
      high = {std::max<double>(high.x, p.x), std::max<double>(high.y, p.y), std::max<double>(high.z, p.z)};
    }
  }
  return low.x <= high.x ? length(high - low) : 0;
}

// The largest distance, over all vertices, of `at` from the point at `s` (0..1) on the line from `from` to `to`.
double distance_to_line(const MeshShape& from, const MeshShape& at, const MeshShape& to, double s) {
  double farthest = 0;
  for (std::size_t g = 0; g < at.size(); ++g) {
    for (std::size_t i = 0; i < at[g].positions.size(); ++i) {
      const Vec3d on_line = to_double(from[g].positions[i]) * (1 - s) + to_double(to[g].positions[i]) * s;
      farthest = std::max(farthest, length(to_double(at[g].positions[i]) - on_line));
    }
  }
  return farthest;
}

// The mesh at as few equal steps of the open shutter as kStraightness allows.
std::vector<MeshShape> shapes_of(const Scene& scene, const Mesh& mesh, const std::vector<MeshPose>& poses,
                                 int threads) {
  const auto at = [&](std::size_t step) { return shape_of(scene, mesh, poses[step], threads); };
  if (poses.size() == 1) {
    return {at(0)};
  }
  std::vector<MeshShape> quarters;
  for (std::size_t i = 0; i <= 4; ++i) {
    quarters.push_back(at(i * kMostSteps / 4));
  }
  const double allowed = kStraightness * size_of(quarters[2]);
  const double whole = std::max({distance_to_line(quarters[0], quarters[1], quarters[4], 0.25),
                                 distance_to_line(quarters[0], quarters[2], quarters[4], 0.5),
                                 distance_to_line(quarters[0], quarters[3], quarters[4], 0.75)});
  if (whole <= allowed) {
    return {std::move(quarters[0]), std::move(quarters[4])};
  }
  const double half = std::max(distance_to_line(quarters[0], quarters[1], quarters[2], 0.5),
                               distance_to_line(quarters[2], quarters[3], quarters[4], 0.5));
  if (half / 4 <= allowed) {  // in a smooth motion, half the step has a quarter of the distance
    return quarters;
  }
  std::vector<MeshShape> all;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    all.push_back(i % 4 == 0 ? std::move(quarters[i / 4]) : at(i));
  }
  return all;
}

}  // namespace

ShapeWay::Corners ShapeWay::at(std::uint32_t triangle, float time) const {
  const float step = time * static_cast<float>(keys.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(step), keys.size() - 2);
  const float s = step - static_cast<float>(first);
  const TriangleShape& a = keys[first][triangle - first_triangle];
  const TriangleShape& b = keys[first + 1][triangle - first_triangle];
  Corners corners;
  for (std::size_t c = 0; c < 3; ++c) {
    corners.position[c] = a.position[c] * (1.0F - s) + b.position[c] * s;
    corners.normal[c] = normalize(normalize(decode_octahedral(a.normal[c])) * (1.0F - s) +
                                  normalize(decode_octahedral(b.normal[c])) * s);
    corners.tangent[c] = decode_octahedral(a.tangent[c]) * (1.0F - s) + decode_octahedral(b.tangent[c]) * s;
  }
  return corners;
}

std::uint32_t RenderScene::add_deforming(const Scene& scene, std::size_t scene_instance, std::uint32_t instance,
                                         const TracerOptions& options) {
  threads_ = options.threads;
  const Instance& source = scene.instances[scene_instance];
  const auto mesh_index = static_cast<std::size_t>(source.mesh);
  const Mesh& mesh = scene.meshes[mesh_index];
  const MeshPose& rest = scene.deformations[static_cast<std::size_t>(source.deformation)].rest;
  DeformingInstance deforming;
  deforming.instance = instance;
  deforming.scene_instance = static_cast<std::uint32_t>(scene_instance);
  deforming.first_geometry = static_cast<std::uint32_t>(geometries.size());
  deforming.poses = {rest};
  const MeshShape shape = shape_of(scene, mesh, rest, threads_);
  std::vector<RayGeometry> parts;
  ShapeWay way;
  way.first_triangle = static_cast<std::uint32_t>(triangles.size());
  for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
    if (mesh.geometries[g].triangles.empty()) {
      continue;
    }
    parts.push_back(add_geometry(scene, mesh_index, g, kNoId, &shape[parts.size()]));
  }
  deforming.geometry_count = static_cast<std::uint32_t>(parts.size());
  deforming.ray_mesh = rays->add_deforming_mesh(parts, options.mesh_update);
  shape_ways.push_back(std::move(way));
  deforming_.push_back(std::move(deforming));
  return deforming_.back().ray_mesh;
}

bool RenderScene::is_in_pose(std::uint32_t scene_instance, const MeshPose& pose) const {
  return std::any_of(deforming_.begin(), deforming_.end(), [&](const DeformingInstance& deforming) {
    return deforming.scene_instance == scene_instance && deforming.poses.size() == 1 && deforming.poses[0] == pose;
  });
}

void RenderScene::deform_meshes(const Scene& scene, const std::optional<ShutterTimes>& times) {
  for (std::size_t d = 0; d < deforming_.size(); ++d) {
    DeformingInstance& deforming = deforming_[d];
    const Instance& source = scene.instances[deforming.scene_instance];
    ShadingInstance& instance = instances[deforming.instance];
    std::vector<MeshPose> poses = poses_of(scene.deformations[static_cast<std::size_t>(source.deformation)], times);
    if (poses == deforming.poses) {
      continue;
    }
    const auto mesh_index = static_cast<std::size_t>(source.mesh);
    const std::vector<MeshShape> shapes = shapes_of(scene, scene.meshes[mesh_index], poses, threads_);
    const bool blurs_here = shapes.size() > 1;
    // An error below leaves triangles of several poses: it must not look as if the mesh were in any of them.
    deforming.poses.clear();
    ShapeWay& way = shape_ways[d];
    way.keys.assign(blurs_here ? shapes.size() : 0, {});
    for (std::uint32_t g = 0; g < deforming.geometry_count; ++g) {
      const GeometryRecord& record = geometries[deforming.first_geometry + g];
      const Geometry& geometry = scene.meshes[mesh_index].geometries[record.scene_geometry];
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        // The middle shape comes last and stays in `triangles`.
        const std::size_t key = (k + shapes.size() / 2 + 1) % shapes.size();
        const DeformedVertices& now = shapes[key][g];
        check_positions(now.positions, scene, mesh_index, record.scene_geometry);
        const SurfaceVertices vertices{now.positions, now.normals, now.tangents, nullptr, &now};
        const auto repaints = [](const MorphTarget& target) {
          return !(target.uv0.empty() && target.uv1.empty() && target.colors.empty());
        };
        const bool painted = std::any_of(geometry.morph_targets.begin(), geometry.morph_targets.end(), repaints);
        const std::size_t count = geometry.triangles.size();
        if (blurs_here) {
          way.keys[key].resize(way.keys[key].size() + count);
        }
        parallel_for((count + kBlock - 1) / kBlock, threads_, [&](std::size_t block) {
          for (std::size_t t = block * kBlock; t < std::min(count, (block + 1) * kBlock); ++t) {
            ShadingTriangle& triangle = triangles[record.first_triangle + t];
            if (painted) {
              paint_triangle(scene, geometry, &now, geometry.triangles[t], triangle);
            }
            shape_triangle(vertices, geometry.triangles[t], triangle);
            if (blurs_here) {
              way.keys[key][record.first_triangle + t - way.first_triangle] = {triangle.position, triangle.normal,
                                                                               triangle.tangent};
            }
          }
        });
      }
    }
    std::vector<std::vector<std::vector<Vec3f>>> positions(shapes.size());
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      for (const DeformedVertices& geometry : shapes[k]) {
        positions[k].push_back(geometry.positions);
      }
    }
    rays->deform_mesh(deforming.ray_mesh, positions);
    rays->refresh_instance(first_instance_id + deforming.instance);
    instance.shape_way = blurs_here ? static_cast<std::uint32_t>(d) : kNoId;
    deforming.poses = std::move(poses);
  }
}

}  // namespace gazetrace
