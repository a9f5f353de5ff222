// SPDX-License-Identifier: Apache-2.0
#include "scene/smooth_glass.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "scene/texel.hpp"

namespace gazetrace {
namespace {

constexpr float kSmooth = 0.2F;  // perceptual roughness

// The least value of channel G, which holds the roughness.
float least_green(const Texture& texture) {
  float least = 1;
  const std::vector<std::uint8_t>& rgba = texture.levels.front().rgba;
  for (std::size_t at = 0; at < rgba.size(); at += texel_bytes(texture.format)) {
    least = std::min(least, texture.format == TexelFormat::unorm8 ? static_cast<float>(rgba[at + 1]) / 255.0F
                                                                  : deep_texel(&rgba[at], texture.format).y);
  }
  return least;
}

bool is_smooth_glass(const Scene& scene, const Material& material) {
  if (!layers_of(material).transmission) {
    return false;
  }
  const TextureRef& ref = material.metallic_roughness_texture;
  return material.roughness < kSmooth ||
         (ref.present() &&
          material.roughness * least_green(scene.textures[static_cast<std::size_t>(ref.texture)]) < kSmooth);
}

}  // namespace

void warn_of_lights_behind_glass(const Scene& scene, Warnings& warnings) {
  if (scene.lights.empty()) {
    return;
  }
  std::vector<char> used(scene.materials.size(), 0);
  for (const Instance& instance : scene.instances) {
    for (const Geometry& geometry : scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries) {
      used[static_cast<std::size_t>(geometry.material)] = 1;
    }
  }
  std::size_t count = 0;
  std::string first;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] != 0 && is_smooth_glass(scene, scene.materials[i]) && count++ == 0) {
      first = "materials[" + std::to_string(i) + "] '" + scene.materials[i].name + "'";
    }
  }
  if (count > 0) {
    warnings.push_back(
        "light of punctual lights through smooth glass (" + first +
        (count > 1 ? ", and " + std::to_string(count - 1) + " more" : "") +
        ") arrives as rare bright pixels, and hardly at all with few samples; a roughness of 0.3, or lights "
        "that have a size, avoid that");
  }
}

}  // namespace gazetrace
