// SPDX-License-Identifier: Apache-2.0
// Summarises the content of a scene, for the user and for the choice of a kernel.
#include <algorithm>
#include <limits>

#include "gazetrace/scene.hpp"

namespace gazetrace {
namespace {

bool emits(const Material& material) {
  return material.emission.x > 0 || material.emission.y > 0 || material.emission.z > 0;
}

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

struct Box {
  Vec3d low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d high = -low;
  void add(const Vec3d& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

bool is_along_one_axis(const Vec3d& v) {
  return (v.x != 0 ? 1 : 0) + (v.y != 0 ? 1 : 0) + (v.z != 0 ? 1 : 0) <= 1;
}

// The corners of a box stand for all vertices in it only where their axes stay axes.
bool keeps_boxes(const Affine& map) {
  return is_along_one_axis(map.x) && is_along_one_axis(map.y) && is_along_one_axis(map.z);
}

void add_corners(Box& world, const Box& own, const Affine& to_world) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    world.add(transform_point(to_world,
                              {(corner & 1U) != 0 ? own.high.x : own.low.x, (corner & 2U) != 0 ? own.high.y : own.low.y,
                               (corner & 4U) != 0 ? own.high.z : own.low.z}));
  }
}

}  // namespace

SceneFeatures features_of(const Scene& scene) {
  SceneFeatures features;
  std::vector<std::size_t> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) {
    ++uses[static_cast<std::size_t>(instance.mesh)];
    features.motion = features.motion || instance.motion >= 0 || instance.deformation >= 0;
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (uses[m] == 0) {
      continue;
    }
    features.instances = features.instances || uses[m] > 1;
    for (const Geometry& geometry : scene.meshes[m].geometries) {
      const Material& material = scene.materials[static_cast<std::size_t>(geometry.material)];
      features.textures = features.textures || material.base_color_texture.present() ||
                          material.metallic_roughness_texture.present() || material.emissive_texture.present();
      features.normal_maps = features.normal_maps || material.normal_texture.present();
      features.vertex_colors = features.vertex_colors || !geometry.colors.empty();
      features.alpha_mask = features.alpha_mask || material.alpha_mode == AlphaMode::mask;
      features.alpha_blend = features.alpha_blend || material.alpha_mode == AlphaMode::blend;
      features.emissive_triangles = features.emissive_triangles || emits(material);
      features.unlit = features.unlit || material.unlit;
      features.layers = features.layers | layers_of(material);
      for (const TextureRef* ref : layer_textures(material)) {
        features.textures = features.textures || ref->present();
      }
    }
  }
  features.textures = features.textures || features.normal_maps;
  features.punctual_lights = !scene.lights.empty();
  features.environment = scene.environment.present();
  return features;
}

SceneSummary summarize(const Scene& scene) {
  SceneSummary summary;
  std::vector<std::uint64_t> triangles(scene.meshes.size(), 0);
  std::vector<std::uint64_t> emissive(scene.meshes.size(), 0);
  std::vector<Box> boxes(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    for (const Geometry& geometry : scene.meshes[m].geometries) {
      triangles[m] += geometry.triangles.size();
      if (emits(scene.materials[static_cast<std::size_t>(geometry.material)])) {
        emissive[m] += geometry.triangles.size();
      }
      summary.vertices += geometry.positions.size();
      ++summary.geometries;
      summary.geometry_bytes += bytes_of(geometry.positions) + bytes_of(geometry.normals) +
                                bytes_of(geometry.tangents) + bytes_of(geometry.uv0) + bytes_of(geometry.uv1) +
                                bytes_of(geometry.colors) + bytes_of(geometry.triangles);
      for (const Vec3f& position : geometry.positions) {
        boxes[m].add(to_double(position));
      }
    }
    summary.triangles_unique += triangles[m];
  }
  Box world;
  for (const Instance& instance : scene.instances) {
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    summary.triangles_instanced += triangles[mesh];
    summary.emissive_triangles += emissive[mesh];
    if (instance.deformation < 0 && keeps_boxes(instance.to_world)) {
      add_corners(world, boxes[mesh], instance.to_world);
      continue;
    }
    const auto add = [&](const std::vector<Vec3f>& positions) {
      for (const Vec3f& position : positions) {
        world.add(transform_point(instance.to_world, to_double(position)));
      }
    };
    for (const Geometry& geometry : scene.meshes[mesh].geometries) {
      if (instance.deformation < 0) {
        add(geometry.positions);
      } else {
        const MeshPose& rest = scene.deformations[static_cast<std::size_t>(instance.deformation)].rest;
        add(deform(geometry, rest, TextureRef{}).positions);
      }
    }
  }
  summary.bounds_min = world.low;
  summary.bounds_max = world.high;
  summary.meshes = scene.meshes.size();
  summary.instances = scene.instances.size();
  summary.materials = scene.materials.size();
  summary.textures = scene.textures.size();
  summary.lights = scene.lights.size();
  for (const Texture& texture : scene.textures) {
    for (const Texture::Level& level : texture.levels) {
      summary.texture_bytes += level.rgba.size();
    }
  }
  return summary;
}

}  // namespace gazetrace
