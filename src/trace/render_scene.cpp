// SPDX-License-Identifier: Apache-2.0
#include "trace/render_scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/hash.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "trace/instance_transform.hpp"
#include "trace/octahedral.hpp"

namespace gazetrace {
namespace {

Vec3d transform_normal(const std::array<Vec3d, 3>& columns, const Vec3d& v) {
  return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
}

// Any tangent will do where texture coordinates have none.
Vec3d some_tangent(const Vec3d& n) {
  const Vec3d axis = std::fabs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalize(cross(axis, n));
}

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

// Loading refuses such numbers; an instance's matrix or a program may still make them. The ray library would leave the
// triangle out without a word.
void check_positions(const std::vector<Vec3f>& positions, const Scene& scene, std::size_t mesh, std::size_t primitive) {
  const auto usable = [](float x) { return std::fabs(x) <= kLargestCoordinate; };  // NaN is not
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f& p = positions[i];
    if (!usable(p.x) || !usable(p.y) || !usable(p.z)) {
      throw Error(ErrorKind::input, scene.source,
                  "mesh " + std::to_string(mesh) + " '" + scene.meshes[mesh].name + "', primitive " +
                      std::to_string(primitive) + ": vertex " + std::to_string(i) +
                      " is not finite, or beyond 1e18 m in the world",
                  "repair the model, or the scale of its nodes");
    }
  }
}

std::uint32_t triangle_count(const Mesh& mesh) {
  std::size_t count = 0;
  for (const Geometry& geometry : mesh.geometries) {
    count += geometry.triangles.size();
  }
  return static_cast<std::uint32_t>(count);
}

}  // namespace

void RenderScene::add_triangles(const Scene& scene, const Geometry& geometry, const Affine* to_world,
                                RayGeometry& out) {
  const auto material_index = static_cast<std::size_t>(geometry.material);
  const ShadingMaterial& material = materials[material_index];
  const TextureRef* shared = shared_coordinates(scene.materials[material_index]);
  const bool extra = needs_extra(geometry, material, layered.of(static_cast<std::uint32_t>(material_index)));
  const bool mirrored = to_world != nullptr && determinant(*to_world) < 0;
  const auto normal_map = to_world != nullptr ? cofactors(*to_world) : cofactors(Affine{});
  const double normal_sign = mirrored ? -1.0 : 1.0;

  out.alpha = material.alpha_mode != AlphaMode::opaque;
  out.tag = static_cast<std::uint32_t>(triangles.size());
  out.positions.reserve(geometry.positions.size());
  for (const Vec3f& p : geometry.positions) {
    out.positions.push_back(to_world != nullptr ? to_float(transform_point(*to_world, to_double(p))) : p);
  }
  out.triangles = geometry.triangles;
  if (mirrored) {
    // glTF 2.0 section 3.7.4: a negative determinant reverses the winding.
    for (auto& t : out.triangles) {
      std::swap(t[1], t[2]);
    }
  }

  for (const auto& corner : out.triangles) {
    ShadingTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.position[k] = out.positions[corner[k]];
      triangle.uv[k] = transformed_uv(shared, geometry, corner[k]);
    }
    const Vec3d e1 = to_double(triangle.position[1]) - to_double(triangle.position[0]);
    const Vec3d e2 = to_double(triangle.position[2]) - to_double(triangle.position[0]);
    const Vec3d face = cross(e1, e2);
    const double twice_area = length(face);
    const Vec3d flat = twice_area > 0 ? face / twice_area : Vec3d{0, 0, 1};
    const Vec2f& a = triangle.uv[0];
    const Vec2d d1{static_cast<double>(triangle.uv[1].x) - a.x, static_cast<double>(triangle.uv[1].y) - a.y};
    const Vec2d d2{static_cast<double>(triangle.uv[2].x) - a.x, static_cast<double>(triangle.uv[2].y) - a.y};
    const double twice_uv_area = d1.x * d2.y - d1.y * d2.x;
    triangle.lod = -100.0F;
    if (twice_area > 0 && std::isfinite(twice_uv_area) && twice_uv_area != 0) {
      triangle.lod = static_cast<float>(0.5 * std::log2(std::fabs(twice_uv_area) / twice_area));
    }
    float sign = twice_uv_area < 0 ? -1.0F : 1.0F;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = corner[k];
      Vec3d n = flat;
      if (vertex < geometry.normals.size()) {
        const Vec3d given = normalize(transform_normal(normal_map, to_double(geometry.normals[vertex])) * normal_sign);
        if (is_finite(given) && dot(given, given) > 0) {
          n = given;
        }
      }
      triangle.normal[k] = encode_octahedral(to_float(n));
      Vec3d t;
      if (vertex < geometry.tangents.size()) {
        const Vec4f& given = geometry.tangents[vertex];
        t = to_double(Vec3f{given.x, given.y, given.z});
        t = normalize(to_world != nullptr ? transform_vector(*to_world, t) : t);
        sign = given.w * static_cast<float>(normal_sign);
      } else if (twice_uv_area != 0) {
        t = normalize((e1 * d2.y - e2 * d1.y) / twice_uv_area);
      }
      if (!is_finite(t) || dot(t, t) == 0) {
        t = some_tangent(n);
      }
      triangle.tangent[k] = encode_octahedral(to_float(t));
    }
    triangle.material_and_sign = (static_cast<std::uint32_t>(material_index) << 1U) | (sign < 0 ? 1U : 0U);
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
    : materials(make_materials(scene, texels)), layered(make_layered_materials(scene)), features(features_of(scene)) {
  const Stopwatch watch;
  const AlphaSource* alpha = this;
  rays = std::make_unique<RayScene>(options.threads, options.bvh_quality == BvhQuality::high, alpha);

  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) {
    ++uses[static_cast<std::size_t>(instance.mesh)];
  }
  // A mesh used once has no use for an instance's indirection.
  std::vector<char> baked(scene.instances.size(), 0);
  std::vector<char> shared(scene.meshes.size(), 0);
  std::size_t total = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    const Instance& instance = scene.instances[i];
    baked[i] = instance.motion < 0 && (uses[mesh] == 1 || !can_be_instanced(instance.to_world)) ? 1 : 0;
    total += baked[i] != 0 ? triangle_count(scene.meshes[mesh]) : 0;
    shared[mesh] = static_cast<char>(shared[mesh] | (baked[i] == 0 ? 1 : 0));
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    total += shared[m] != 0 ? triangle_count(scene.meshes[m]) : 0;
  }
  triangles.reserve(total);

  // Where something moves, all that stands still is one mesh: a new frame builds the small tree above anew, not this.
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
      add_triangles(scene, mesh.geometries[g], &scene.instances[i].to_world, ray_geometry);
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
      add_triangles(scene, geometry, nullptr, parts.emplace_back());
      check_positions(parts.back().positions, scene, m, g);
    }
    mesh_id[m] = rays->add_mesh(parts);
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (baked[i] != 0) {
      continue;
    }
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    // A motion may begin anywhere; what cannot be instanced is hidden until it can.
    const bool usable = can_be_instanced(scene.instances[i].to_world);
    const Affine to_world = usable ? scene.instances[i].to_world : Affine{};
    ShadingInstance instance = shading_instance(to_world);
    instance.first_geometry = mesh_first_geometry[mesh];
    instance.scene_instance = static_cast<std::uint32_t>(i);
    if (scene.instances[i].motion >= 0) {
      moving_.push_back({static_cast<std::uint32_t>(instances.size()), static_cast<std::uint32_t>(i)});
    }
    instances.push_back(instance);
    const std::uint32_t id = rays->add_instance(mesh_id[mesh], ray_transform(to_world));
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
    // Level 0 always: averaged coverage under a threshold would thin out or thicken foliage with distance.
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
