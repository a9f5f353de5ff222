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

Vec2f transformed_uv(const TextureRef* ref, const Geometry& geometry, std::uint32_t vertex) {
  if (ref == nullptr) {
    return {};
  }
  const std::vector<Vec2f>& set = ref->uv_set == 1 ? geometry.uv1 : geometry.uv0;
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

}  // namespace

void RenderScene::add_triangles(const Scene& scene, const Geometry& geometry, const DeformedVertices* shape,
                                const Affine* to_world, RayGeometry& out) {
  const auto material_index = static_cast<std::size_t>(geometry.material);
  const ShadingMaterial& material = materials[material_index];
  const TextureRef* shared = shared_coordinates(scene.materials[material_index]);
  const bool extra = needs_extra(geometry, material, layered.of(static_cast<std::uint32_t>(material_index)));

  out.alpha = material.alpha_mode != AlphaMode::opaque;
  out.tag = static_cast<std::uint32_t>(triangles.size());
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
  const SurfaceVertices vertices{out.positions, shape != nullptr ? shape->normals : geometry.normals,
                                 shape != nullptr ? shape->tangents : geometry.tangents, to_world};

  for (const auto& corner : out.triangles) {
    ShadingTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.uv[k] = transformed_uv(shared, geometry, corner[k]);
    }
    triangle.material_and_sign = static_cast<std::uint32_t>(material_index) << 1U;
    shape_triangle(vertices, corner, triangle);
    if (extra) {
      TriangleExtra more;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = corner[k];
        more.uv0[k] = vertex < geometry.uv0.size() ? geometry.uv0[vertex] : Vec2f{};
        more.uv1[k] = vertex < geometry.uv1.size() ? geometry.uv1[vertex] : Vec2f{};
        more.color[k] = vertex < geometry.colors.size() ? geometry.colors[vertex] : Vec4f{1, 1, 1, 1};
      }
      triangle.extra = static_cast<std::uint32_t>(extras.size());
      extras.push_back(more);
    }
    triangles.push_back(triangle);
  }
}

RenderScene::RenderScene(const Scene& scene, const TracerOptions& options)
    : materials(make_materials(scene)), layered(make_layered_materials(scene)), features(features_of(scene)) {
  const Stopwatch watch;
  const AlphaSource* alpha = this;
  rays = std::make_unique<RayScene>(options.threads, options.bvh_quality == BvhQuality::high, alpha);

  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) {
    ++uses[static_cast<std::size_t>(instance.mesh)];
  }
  // A mesh that is used once is baked to world space, which saves the indirection of an instance.
  std::vector<char> baked(scene.instances.size(), 0);
  std::vector<char> shared(scene.meshes.size(), 0);
  std::size_t total = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    const Instance& instance = scene.instances[i];
    if (instance.deformation >= 0) {
      total += triangle_count(scene.meshes[mesh]);
      continue;
    }
    baked[i] = instance.motion < 0 && (uses[mesh] == 1 || !can_be_instanced(instance.to_world)) ? 1 : 0;
    total += baked[i] != 0 ? triangle_count(scene.meshes[mesh]) : 0;
    shared[mesh] = static_cast<char>(shared[mesh] | (baked[i] == 0 ? 1 : 0));
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    total += shared[m] != 0 ? triangle_count(scene.meshes[m]) : 0;
  }
  triangles.reserve(total);

  // Where something moves, everything that stands still is one mesh, so that a new frame rebuilds only the small BVH
  // above.
  std::vector<RayGeometry> still;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (baked[i] == 0) {
      continue;
    }
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)];
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      if (mesh.geometries[g].triangles.empty()) {
        continue;
      }
      RayGeometry ray_geometry;
      geometries.push_back(
          {static_cast<std::uint32_t>(triangles.size()), static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(g)});
      add_triangles(scene, mesh.geometries[g], nullptr, &scene.instances[i].to_world, ray_geometry);
      check_positions(ray_geometry.positions, scene, static_cast<std::size_t>(scene.instances[i].mesh), g);
      if (features.motion) {
        still.push_back(std::move(ray_geometry));
      } else {
        rays->add_geometry(ray_geometry);
      }
    }
  }
  if (!still.empty()) {
    ShadingInstance whole = shading_instance(Affine{});
    whole.scene_instance = kNoId;
    instances.push_back(whole);
    rays->add_instance(rays->add_mesh(still), ray_transform(Affine{}));
    still.clear();
  }
  first_instance_id = features.motion ? 0 : static_cast<std::uint32_t>(geometries.size());

  std::vector<std::uint32_t> mesh_id(scene.meshes.size(), kNoId);
  std::vector<std::uint32_t> mesh_first_geometry(scene.meshes.size(), 0);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (shared[m] == 0) {
      continue;
    }
    mesh_first_geometry[m] = static_cast<std::uint32_t>(geometries.size());
    std::vector<RayGeometry> parts;
    for (std::size_t g = 0; g < scene.meshes[m].geometries.size(); ++g) {
      const Geometry& geometry = scene.meshes[m].geometries[g];
      if (geometry.triangles.empty()) {
        continue;
      }
      geometries.push_back({static_cast<std::uint32_t>(triangles.size()), kNoId, static_cast<std::uint32_t>(g)});
      add_triangles(scene, geometry, nullptr, nullptr, parts.emplace_back());
      check_positions(parts.back().positions, scene, m, g);
    }
    mesh_id[m] = rays->add_mesh(parts);
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (baked[i] != 0) {
      continue;
    }
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    // A motion may begin with any transform; an instance that the ray library cannot handle is hidden until it can.
    const bool usable = can_be_instanced(scene.instances[i].to_world);
    const Affine to_world = usable ? scene.instances[i].to_world : Affine{};
    ShadingInstance instance = shading_instance(to_world);
    instance.first_geometry = mesh_first_geometry[mesh];
    instance.scene_instance = static_cast<std::uint32_t>(i);
    std::uint32_t ray_mesh = mesh_id[mesh];
    if (scene.instances[i].deformation >= 0) {
      instance.first_geometry = static_cast<std::uint32_t>(geometries.size());
      ray_mesh = add_deforming(scene, i, static_cast<std::uint32_t>(instances.size()), options);
      instance.flip = is_mirrored(scene.deformations[static_cast<std::size_t>(scene.instances[i].deformation)].rest)
                          ? -instance.flip
                          : instance.flip;
    }
    if (scene.instances[i].motion >= 0) {
      moving_.push_back({static_cast<std::uint32_t>(instances.size()), static_cast<std::uint32_t>(i)});
    }
    instances.push_back(instance);
    const std::uint32_t id = rays->add_instance(ray_mesh, ray_transform(to_world));
    if (!usable) {
      rays->place_instance(id, {});
    }
  }
  rays->commit();
  build_s = watch.elapsed_ms() * 1e-3;
}

bool RenderScene::transparent(std::uint32_t tag, std::uint32_t primitive, float u, float v, std::uint32_t key) const {
  const ShadingTriangle& triangle = triangles[tag + primitive];
  const ShadingMaterial& material = materials[triangle.material_and_sign >> 1U];
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
