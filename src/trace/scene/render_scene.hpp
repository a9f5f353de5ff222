// SPDX-License-Identifier: Apache-2.0
// The scene as the inner loops read it: one record a triangle, compact materials, and the BVH.
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

// Rarely needed: vertex colours, and texture coordinates where a material's textures do not share them.
struct TriangleExtra {
  std::array<Vec2f, 3> uv0, uv1;
  std::array<Vec4f, 3> color;
};

struct ShadingInstance {
  std::array<Vec3f, 3> axes;  // columns of the linear part
  Vec3f translation;
  std::array<Vec3f, 3> normal_axes;  // columns of the cofactor matrix: normals' transform, up to a positive factor
  float lod_offset = 0;              // -log2 of the mean scale
  float flip = 1;                    // -1 for mirroring matrices
  std::uint32_t first_geometry = 0;  // into RenderScene::geometries
  std::uint32_t scene_instance = 0;  // index into Scene::instances; kNoId: the geometry's record knows
  std::uint32_t way = kNoId;         // moves while the shutter is open: index into RenderScene::ways
  std::uint32_t shape_way = kNoId;   // changes its shape meanwhile: index into RenderScene::shape_ways
};

// Where an instance is at equal steps from opening to closing of the shutter, linear between, as rays meet it.
using InstanceWay = std::vector<RayTransform>;

// The triangles of an instance that changes its shape while the shutter is open, at equal steps, linear between.
struct ShapeWay {
  std::uint32_t first_triangle = 0;  // into RenderScene::triangles
  std::vector<std::vector<TriangleShape>> keys;
  // Corners as gather_triangles wants them; normals and tangents are not normalised.
  struct Corners {
    std::array<Vec3f, 3> position, normal, tangent;
  };
  [[nodiscard]] Corners at(std::uint32_t triangle, float time) const;
};

// One per geometry of a shared mesh, and one per (instance, geometry) of baked ones.
struct GeometryRecord {
  std::uint32_t first_triangle = 0;
  std::uint32_t scene_instance = kNoId;  // baked: index into Scene::instances
  std::uint32_t scene_geometry = 0;      // index into Mesh::geometries
};

class RenderScene : private AlphaSource {
 public:
  RenderScene(const Scene& scene, const TracerOptions& options);
  RenderScene(const RenderScene&) = delete;  // the BVH's alpha test points here
  RenderScene& operator=(const RenderScene&) = delete;

  // Puts what moves to where it is then, or at rest without times; see PathTracer::at.
  void move_to(const Scene& scene, const std::optional<ShutterTimes>& times);
  // Whether a deforming instance (of Scene::instances) stands in that pose now.
  [[nodiscard]] bool is_in_pose(std::uint32_t scene_instance, const MeshPose& pose) const;
  // `time`: 0..1 while the shutter is open.
  [[nodiscard]] ShadingInstance instance_at(std::uint32_t instance, float time) const;

  // Top-level hits: geometry id -> record. Instances: their id - first_instance_id -> instances.
  std::vector<ShadingTriangle> triangles;
  std::vector<TriangleExtra> extras;
  std::vector<GeometryRecord> geometries;
  std::vector<ShadingInstance> instances;
  std::vector<InstanceWay> ways;
  std::vector<ShapeWay> shape_ways;
  bool blurs = false;  // something moves while the shutter is open: rays need their time
  std::uint32_t first_instance_id = 0;
  std::vector<ShadingMaterial> materials;
  LayeredMaterials layered;
  SceneFeatures features;
  std::unique_ptr<RayScene> rays;
  double build_s = 0;

 private:
  bool transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v, std::uint32_t key) const override;
  // `shape`: the geometry's vertices as they are now, where they are not those of the geometry.
  void add_triangles(const Scene& scene, const Geometry& geometry, const DeformedVertices* shape,
                     const Affine* to_world, RayGeometry& out);
  // The mesh of an instance that deforms, at rest; returns the ray library's mesh.
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
    std::vector<MeshPose> poses;  // that the mesh was last put into, over the open shutter
  };
  std::vector<DeformingInstance> deforming_;
  int threads_ = 0;
};

}  // namespace gazetrace
