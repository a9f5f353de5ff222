// SPDX-License-Identifier: Apache-2.0
// The scene in the form that the inner loops read: one record per triangle, compact materials, and the BVH.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "trace/rays/embree.hpp"
#include "trace/scene/layered_material.hpp"
#include "trace/scene/shading_triangle.hpp"
#include "trace/scene/texture.hpp"

namespace gazetrace {

// Data that few triangles need: vertex colours, and texture coordinates where a material's textures do not share them.
struct TriangleExtra {
  std::array<Vec2f, 3> uv0, uv1;
  std::array<Vec4f, 3> color;
};

struct ShadingInstance {
  std::array<Vec3f, 3> axes;  // columns of the linear part
  Vec3f translation;
  std::array<Vec3f, 3> normal_axes;  // columns of the cofactor matrix, up to a positive factor; transforms normals
  float lod_offset = 0;              // -log2 of the mean scale
  float flip = 1;                    // -1 for mirroring matrices
  std::uint32_t first_geometry = 0;  // into RenderScene::geometries
  std::uint32_t scene_instance = 0;  // index into Scene::instances; kNoId: it is in the GeometryRecord
  std::uint32_t way = kNoId;         // index into RenderScene::ways, where it moves while the shutter is open
  std::uint32_t shape_way = kNoId;   // index into RenderScene::shape_ways, where it changes its shape meanwhile
};

// The transforms of an instance at equal steps from the opening to the closing of the shutter, in the form that rays
// use; linear in between.
using InstanceWay = std::vector<RayTransform>;

// The triangles of an instance that changes its shape while the shutter is open, at equal steps of time; linear in
// between.
struct ShapeWay {
  std::uint32_t first_triangle = 0;  // into RenderScene::triangles
  std::vector<std::vector<TriangleShape>> keys;
  // Corners as gather_triangles needs them; tangents are not normalised.
  struct Corners {
    std::array<Vec3f, 3> position, normal, tangent;
  };
  [[nodiscard]] Corners at(std::uint32_t triangle, float time) const;
};

// There is one record per geometry of a shared mesh, and one per (instance, geometry) of baked meshes.
struct GeometryRecord {
  std::uint32_t first_triangle = 0;
  std::uint32_t scene_instance = kNoId;  // baked: index into Scene::instances
  std::uint32_t scene_geometry = 0;      // index into Mesh::geometries
};

class RenderScene : private AlphaSource {
 public:
  RenderScene(const Scene& scene, const TracerOptions& options, const Vec3d& origin = {});
  RenderScene(const RenderScene&) = delete;  // the BVH's alpha test keeps a pointer to this object
  RenderScene& operator=(const RenderScene&) = delete;

  // Moves and deforms everything to its state at these times, or to rest without times; see PathTracer::at.
  void move_to(const Scene& scene, const std::optional<ShutterTimes>& times);
  // Whether a deforming instance (index into Scene::instances) is in that pose now.
  [[nodiscard]] bool is_in_pose(std::uint32_t scene_instance, const MeshPose& pose) const;
  // The instance at a time of 0..1 while the shutter is open.
  [[nodiscard]] ShadingInstance instance_at(std::uint32_t instance, float time) const;

  // A hit in the top-level scene has a geometry id that is an index into `geometries`; the id of an instance less
  // first_instance_id is an index into `instances`.
  Vec3d origin_m;  // what its coordinates count from: a point near the camera
  std::vector<ShadingTriangle> triangles;
  std::vector<TriangleExtra> extras;
  std::vector<GeometryRecord> geometries;
  std::vector<ShadingInstance> instances;
  std::vector<InstanceWay> ways;
  std::vector<ShapeWay> shape_ways;
  bool blurs = false;  // something moves while the shutter is open, so rays need a time
  std::uint32_t first_instance_id = 0;
  std::vector<ShadingMaterial> materials;
  LayeredMaterials layered;
  SceneFeatures features;
  std::unique_ptr<RayScene> rays;
  double build_s = 0;

 private:
  bool culled(std::uint32_t tag, std::uint32_t primitive, const Vec3f& direction) const override;
  bool transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v, std::uint32_t key) const override;
  // A mesh that instances refer to: in the ray library, and its first record in `geometries`.
  struct InstancedMesh {
    std::uint32_t ray_mesh = kNoId, first_geometry = 0;
  };
  // The meshes of the instances that are marked, in world space.
  void add_baked_meshes(const Scene& scene, const std::vector<char>& baked);
  // One entry for each mesh of the scene; only those that are marked are added.
  std::vector<InstancedMesh> add_shared_meshes(const Scene& scene, const std::vector<char>& shared);
  // An instance that is not baked; where it deforms, it brings a mesh of its own instead of this one.
  void add_instance(const Scene& scene, std::size_t scene_instance, InstancedMesh mesh, const TracerOptions& options);
  // Adds a geometry of a mesh to the tables above; returns what the ray library gets of it. It is put into world space
  // for a `baked_instance` (index into Scene::instances). `shape` has the geometry's vertices as they are now; nullptr
  // where they are those of the geometry.
  RayGeometry add_geometry(const Scene& scene, std::size_t mesh, std::size_t geometry,
                           std::uint32_t baked_instance = kNoId, const DeformedVertices* shape = nullptr);
  void add_triangles(const Scene& scene, const Geometry& geometry, const SurfaceVertices& vertices,
                     const std::vector<std::array<std::uint32_t, 3>>& corners);
  // Sets what of a triangle and its TriangleExtra depends on texture coordinates and colours.
  void paint_triangle(const Scene& scene, const Geometry& geometry, const DeformedVertices* shape,
                      const std::array<std::uint32_t, 3>& corner, ShadingTriangle& triangle);
  // Adds the mesh of an instance that deforms, at rest; returns the ray library's mesh.
  std::uint32_t add_deforming(const Scene& scene, std::size_t scene_instance, std::uint32_t instance,
                              const TracerOptions& options);
  void deform_meshes(const Scene& scene, const std::optional<ShutterTimes>& times);

  struct MovingInstance {
    std::uint32_t instance = 0, scene_instance = 0;
  };
  std::vector<MovingInstance> moving_;
  struct DeformingInstance {
    std::uint32_t instance = 0, scene_instance = 0, ray_mesh = 0;
    std::uint32_t first_geometry = 0, geometry_count = 0;
    std::vector<MeshPose> poses;  // the poses of the mesh at the last move_to, over the open shutter
  };
  std::vector<DeformingInstance> deforming_;
  int threads_ = 0;
  bool culls_ = false;  // Scene::cull_back_faces
};

}  // namespace gazetrace
