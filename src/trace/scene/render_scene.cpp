// SPDX-License-Identifier: Apache-2.0
#include "trace/scene/render_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/hash.hpp"
#include "core/stopwatch.hpp"
#include "trace/scene/instance_transform.hpp"

namespace gazetrace {
namespace {

// What is painted on a geometry, in the shape that it has now; nullptr: as it is stored.
struct Paint {
  Paint(const Geometry& geometry, const DeformedVertices* shape)
      : uv0(shape != nullptr && !shape->uv0.empty() ? shape->uv0 : geometry.uv0),
        uv1(shape != nullptr && !shape->uv1.empty() ? shape->uv1 : geometry.uv1),
        colors(shape != nullptr && !shape->colors.empty() ? shape->colors : geometry.colors) {}
  const std::vector<Vec2f>& uv0;
  const std::vector<Vec2f>& uv1;
  const std::vector<Vec4f>& colors;
};

Vec2f transformed_uv(const TextureRef* ref, const Paint& paint, std::uint32_t vertex) {
  if (ref == nullptr) {
    return {};
  }
  const std::vector<Vec2f>& set = ref->uv_set == 1 ? paint.uv1 : paint.uv0;
  const Vec2f uv = vertex < set.size() ? set[vertex] : Vec2f{};
  if (!ref->has_transform) {
    return uv;
  }
  const auto& m = ref->transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

bool needs_extra(const Geometry& geometry, const ShadingMaterial& material, const LayeredMaterial* layers) {
  return (layers != nullptr && layers->any_own_uv()) || !geometry.colors.empty() || material.base.own_uv ||
         material.metal_rough.own_uv || material.normal.own_uv || material.emit.own_uv;
}

std::uint32_t triangle_count(const Mesh& mesh) {
  std::size_t count = 0;
  for (const Geometry& geometry : mesh.geometries) {
    count += geometry.triangles.size();
  }
  return static_cast<std::uint32_t>(count);
}

// How the instances of a scene use its meshes.
struct MeshUses {
  std::vector<char> baked;    // of each instance: a mesh in world space is made for it alone
  std::vector<char> shared;   // of each mesh: instances refer to it
  std::size_t triangles = 0;  // of all meshes that are made
};

// A mesh that is used once is baked to world space, which saves the indirection of an instance.
MeshUses uses_of_meshes(const Scene& scene) {
  std::vector<std::uint32_t> count(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) {
    ++count[static_cast<std::size_t>(instance.mesh)];
  }
  MeshUses uses;
  uses.baked.resize(scene.instances.size(), 0);
  uses.shared.resize(scene.meshes.size(), 0);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    if (instance.deformation >= 0) {
      uses.triangles += triangle_count(scene.meshes[mesh]);
      continue;
    }
    if (instance.motion < 0 && (count[mesh] == 1 || !can_be_instanced(instance.to_world))) {
      uses.baked[i] = 1;
      uses.triangles += triangle_count(scene.meshes[mesh]);
    } else {
      uses.shared[mesh] = 1;
    }
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    uses.triangles += uses.shared[m] != 0 ? triangle_count(scene.meshes[m]) : 0;
  }
  return uses;
}

// Vertices and corners as the ray library takes them.
RayGeometry placed(const Geometry& geometry, const DeformedVertices* shape, const Affine* to_world) {
  RayGeometry out;
  out.positions = shape != nullptr ? shape->positions : geometry.positions;
  out.triangles = geometry.triangles;
  if (to_world != nullptr) {
    for (Vec3f& p : out.positions) {
      p = to_float(transform_point(*to_world, to_double(p)));
    }
  }
  if (to_world != nullptr && determinant(*to_world) < 0) {
    // glTF 2.0 section 3.7.4: a negative determinant reverses the winding.
    for (auto& t : out.triangles) {
      std::swap(t[1], t[2]);
    }
  }
  return out;
}

TriangleExtra extra_of(const Paint& paint, const std::array<std::uint32_t, 3>& corner) {
  TriangleExtra extra;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = corner[k];
    extra.uv0[k] = vertex < paint.uv0.size() ? paint.uv0[vertex] : Vec2f{};
    extra.uv1[k] = vertex < paint.uv1.size() ? paint.uv1[vertex] : Vec2f{};
    extra.color[k] = vertex < paint.colors.size() ? paint.colors[vertex] : Vec4f{1, 1, 1, 1};
  }
  return extra;
}

}  // namespace

RenderScene::RenderScene(const Scene& scene, const TracerOptions& options, const Vec3d& origin)
    : origin_m(origin),
      materials(make_materials(scene)),
      layered(make_layered_materials(scene)),
      features(features_of(scene)),
      culls_(scene.cull_back_faces) {
  const Stopwatch watch;
  const AlphaSource* alpha = this;
  rays = std::make_unique<RayScene>(options.threads, alpha);
  const MeshUses uses = uses_of_meshes(scene);
  triangles.reserve(uses.triangles);
  add_baked_meshes(scene, uses.baked);
  first_instance_id = features.motion ? 0 : static_cast<std::uint32_t>(geometries.size());
  const std::vector<InstancedMesh> meshes = add_shared_meshes(scene, uses.shared);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (uses.baked[i] == 0) {
      add_instance(scene, i, meshes[static_cast<std::size_t>(scene.instances[i].mesh)], options);
    }
  }
  rays->commit();
  build_s = watch.elapsed_ms() * 1e-3;
}

// Where something moves, everything that stands still is one mesh, so that a new frame rebuilds only the small BVH
// above.
void RenderScene::add_baked_meshes(const Scene& scene, const std::vector<char>& baked) {
  std::vector<RayGeometry> still;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (baked[i] == 0) {
      continue;
    }
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    for (std::size_t g = 0; g < scene.meshes[mesh].geometries.size(); ++g) {
      if (scene.meshes[mesh].geometries[g].triangles.empty()) {
        continue;
      }
      RayGeometry geometry = add_geometry(scene, mesh, g, static_cast<std::uint32_t>(i));
      if (features.motion) {
        still.push_back(std::move(geometry));
      } else {
        rays->add_geometry(geometry);
      }
    }
  }
  if (!still.empty()) {
    ShadingInstance whole = shading_instance(Affine{});
    whole.scene_instance = kNoId;
    instances.push_back(whole);
    rays->add_instance(rays->add_mesh(still), ray_transform(Affine{}));
  }
}

std::vector<RenderScene::InstancedMesh> RenderScene::add_shared_meshes(const Scene& scene,
                                                                       const std::vector<char>& shared) {
  std::vector<InstancedMesh> meshes(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (shared[m] == 0) {
      continue;
    }
    meshes[m].first_geometry = static_cast<std::uint32_t>(geometries.size());
    std::vector<RayGeometry> parts;
    for (std::size_t g = 0; g < scene.meshes[m].geometries.size(); ++g) {
      if (!scene.meshes[m].geometries[g].triangles.empty()) {
        parts.push_back(add_geometry(scene, m, g));
      }
    }
    meshes[m].ray_mesh = rays->add_mesh(parts);
  }
  return meshes;
}

void RenderScene::add_instance(const Scene& scene, std::size_t scene_instance, InstancedMesh mesh,
                               const TracerOptions& options) {
  const Instance& source = scene.instances[scene_instance];
  // A motion may begin with any transform; an instance that the ray library cannot handle is hidden until it can.
  const bool usable = can_be_instanced(counted_from(origin_m, source.to_world));
  const Affine to_world = counted_from(origin_m, usable ? source.to_world : Affine{});
  ShadingInstance instance = shading_instance(to_world);
  const auto index = static_cast<std::uint32_t>(instances.size());
  if (source.deformation >= 0) {
    mesh.first_geometry = static_cast<std::uint32_t>(geometries.size());
    mesh.ray_mesh = add_deforming(scene, scene_instance, index, options);
  }
  instance.first_geometry = mesh.first_geometry;
  instance.scene_instance = static_cast<std::uint32_t>(scene_instance);
  if (source.motion >= 0) {
    moving_.push_back({index, static_cast<std::uint32_t>(scene_instance)});
  }
  instances.push_back(instance);
  const std::uint32_t id = rays->add_instance(mesh.ray_mesh, ray_transform(to_world));
  if (!usable) {
    rays->place_instance(id, {});
  }
}

RayGeometry RenderScene::add_geometry(const Scene& scene, std::size_t mesh, std::size_t geometry,
                                      std::uint32_t baked_instance, const DeformedVertices* shape) {
  const Geometry& source = scene.meshes[mesh].geometries[geometry];
  const Affine in_world =
      counted_from(origin_m, baked_instance != kNoId ? scene.instances[baked_instance].to_world : Affine{});
  const Affine* to_world = baked_instance != kNoId ? &in_world : nullptr;
  RayGeometry out = placed(source, shape, to_world);
  const ShadingMaterial& material = materials[static_cast<std::size_t>(source.material)];
  out.ask = material.alpha_mode != AlphaMode::opaque || (culls_ && !material.double_sided);
  out.tag = static_cast<std::uint32_t>(triangles.size());
  geometries.push_back({out.tag, baked_instance, static_cast<std::uint32_t>(geometry)});
  add_triangles(scene, source,
                {out.positions, shape != nullptr ? shape->normals : source.normals,
                 shape != nullptr ? shape->tangents : source.tangents, to_world, shape},
                out.triangles);
  check_positions(out.positions, scene, mesh, geometry);
  return out;
}

void RenderScene::add_triangles(const Scene& scene, const Geometry& geometry, const SurfaceVertices& vertices,
                                const std::vector<std::array<std::uint32_t, 3>>& corners) {
  const auto material_index = static_cast<std::size_t>(geometry.material);
  const bool extra =
      needs_extra(geometry, materials[material_index], layered.of(static_cast<std::uint32_t>(material_index)));
  for (const auto& corner : corners) {
    ShadingTriangle triangle;
    triangle.bits = static_cast<std::uint32_t>(material_index) << 2U;
    if (extra) {
      triangle.extra = static_cast<std::uint32_t>(extras.size());
      extras.emplace_back();
    }
    paint_triangle(scene, geometry, vertices.shape, corner, triangle);
    shape_triangle(vertices, corner, triangle);
    triangles.push_back(triangle);
  }
}

void RenderScene::paint_triangle(const Scene& scene, const Geometry& geometry, const DeformedVertices* shape,
                                 const std::array<std::uint32_t, 3>& corner, ShadingTriangle& triangle) {
  const Paint paint(geometry, shape);
  const TextureRef* shared = shared_coordinates(scene.materials[static_cast<std::size_t>(geometry.material)]);
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.uv[k] = transformed_uv(shared, paint, corner[k]);
  }
  if (triangle.extra != kNoId) {
    extras[triangle.extra] = extra_of(paint, corner);
  }
}

bool RenderScene::culled(std::uint32_t tag, std::uint32_t primitive, const Vec3f& direction) const {
  const ShadingTriangle& triangle = triangles[tag + primitive];
  if (!culls_ || materials[triangle.material()].double_sided) {
    return false;
  }
  const Vec3d corner = to_double(triangle.position[0]);
  const Vec3d face = cross(to_double(triangle.position[1]) - corner, to_double(triangle.position[2]) - corner);
  return dot(face, to_double(direction)) * static_cast<double>(triangle.winding()) > 0;
}

bool RenderScene::transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v, std::uint32_t key) const {
  const ShadingTriangle& triangle = triangles[tag + primitive];
  const ShadingMaterial& material = materials[triangle.material()];
  if (material.alpha_mode == AlphaMode::opaque) {
    return false;
  }
  const float w = 1.0F - u - v;
  float alpha = material.base_color.w;
  if (material.base.texture != nullptr) {
    const float s = w * triangle.uv[0].x + u * triangle.uv[1].x + v * triangle.uv[2].x;
    const float t = w * triangle.uv[0].y + u * triangle.uv[1].y + v * triangle.uv[2].y;
    // Always level 0, since averaged coverage under a threshold would make foliage thinner or thicker with distance.
    alpha *= read_alpha(*material.base.texture, s, t);
  }
  if (triangle.extra != kNoId) {
    const auto& color = extras[triangle.extra].color;
    alpha *= w * color[0].w + u * color[1].w + v * color[2].w;
  }
  if (material.alpha_mode == AlphaMode::mask) {
    return alpha < material.alpha_cutoff;
  }
  return static_cast<float>(key >> 8U) * 0x1p-24F >= alpha;
}

}  // namespace gazetrace
