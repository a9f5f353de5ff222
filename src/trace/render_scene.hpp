// SPDX-License-Identifier: Apache-2.0
// The scene as the inner loops read it: one record a triangle, compact materials, and the BVH.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "trace/embree.hpp"
#include "trace/layered_material.hpp"
#include "trace/texture.hpp"

namespace gazetrace {

// All a hit needs in one and a half cache lines. Triangles of meshes used once are in world space, others in the
// mesh's own. Positions are those the BVH was built from, so that points on the triangle are exact to rounding.
struct alignas(32) ShadingTriangle {
  std::array<Vec3f, 3> position;
  std::array<Vec2f, 3> uv;              // of the base colour's texture (first present one), its transform applied
  std::array<std::uint32_t, 3> normal;  // octahedral
  std::array<std::uint32_t, 3> tangent;
  float lod = 0;  // log2 of sqrt(uv area / area): Akenine-Moller et al. 2021, eq. 2, without the texture's size
  std::uint32_t material_and_sign = 0;  // material << 1 | bitangent is negated
  std::uint32_t extra = kNoId;          // index into TriangleExtra
};
static_assert(sizeof(ShadingTriangle) == 96);

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
};

// Where an instance is at equal steps from opening to closing of the shutter, linear between, as rays meet it.
using InstanceWay = std::vector<RayTransform>;

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

  // Puts what moves to where it is then; see PathTracer::move_to.
  void move_to(const Scene& scene, const ShutterTimes& times);
  // `time`: 0..1 while the shutter is open.
  [[nodiscard]] ShadingInstance instance_at(std::uint32_t instance, float time) const;

  // Top-level hits: geometry id -> record. Instances: their id - first_instance_id -> instances.
  std::vector<ShadingTriangle> triangles;
  std::vector<TriangleExtra> extras;
  std::vector<GeometryRecord> geometries;
  std::vector<ShadingInstance> instances;
  std::vector<InstanceWay> ways;
  bool blurs = false;  // something moves while the shutter is open: rays need their time
  std::uint32_t first_instance_id = 0;
  TexelStore texels;
  std::vector<ShadingMaterial> materials;
  LayeredMaterials layered;
  SceneFeatures features;
  std::unique_ptr<RayScene> rays;
  double build_s = 0;

 private:
  bool transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v, std::uint32_t key) const override;
  void add_triangles(const Scene& scene, const Geometry& geometry, const Affine* to_world, RayGeometry& out);

  struct MovingInstance {
    std::uint32_t instance = 0, scene_instance = 0;
  };
  std::vector<MovingInstance> moving_;
};

}  // namespace gazetrace
