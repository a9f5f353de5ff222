// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/material.hpp"

#include <algorithm>
#include <cmath>

#include "scene/gltf/constants.hpp"
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {
namespace {

// KHR_texture_transform: translation * rotation * scale. The angle turns counter-clockwise as one looks at the picture,
// with v pointing down: u' = cos u + sin v, v' = -sin u + cos v. The sign follows from the extension's own example
// (offset 0 1, rotation pi/2, scale 0.5 shows the lower left quadrant).
std::array<float, 6> texture_matrix(const GltfTextureInfo& info) {
  const double c = std::cos(info.rotation_rad);
  const double s = std::sin(info.rotation_rad);
  return {static_cast<float>(c * info.scale[0]), static_cast<float>(s * info.scale[1]),
          static_cast<float>(info.offset[0]),    static_cast<float>(-s * info.scale[0]),
          static_cast<float>(c * info.scale[1]), static_cast<float>(info.offset[1])};
}

class MaterialBuilder {
 public:
  MaterialBuilder(const std::string& path, TextureTable& textures, Warnings& warnings)
      : path_(path), textures_(textures), warnings_(warnings) {}

  Material build(const GltfMaterial& from, std::size_t index) {
    place_ = "materials[" + std::to_string(index) + "] '" + from.name + "'";
    Material to;
    to.name = from.name;
    to.base_color = {unit(from.base_color[0], "baseColorFactor"), unit(from.base_color[1], "baseColorFactor"),
                     unit(from.base_color[2], "baseColorFactor"), unit(from.base_color[3], "baseColorFactor")};
    to.metallic = unit(from.metallic, "metallicFactor");
    to.roughness = unit(from.roughness, "roughnessFactor");
    to.normal_scale = static_cast<float>(from.normal_scale);
    to.alpha_mode = alpha_mode(from.alpha_mode);
    to.alpha_cutoff = static_cast<float>(from.alpha_cutoff);
    to.double_sided = from.double_sided;
    to.unlit = from.unlit;
    to.base_color_texture = texture(from.base_color_texture, TextureUse::color);
    if (!from.unlit) {  // nothing else of an unlit material is visible
      to.metallic_roughness_texture = texture(from.metallic_roughness_texture, TextureUse::data);
      to.normal_texture = texture(from.normal_texture, TextureUse::normal);
      to.emission = to_float(Vec3d{from.emissive[0], from.emissive[1], from.emissive[2]});
      read_extensions(from, index, to);
      to.emission = emission(to.emission);
      if (!(to.emission == Vec3f{})) {
        to.emissive_texture = texture(from.emissive_texture, TextureUse::color);
        if (from.emissive_texture.texture >= 0 && !to.emissive_texture.present()) {
          to.emission = {};  // without the picture it is not known where it emits, and all of it would be a lamp
        }
      }
    }
    return to;
  }

 private:
  void read_extensions(const GltfMaterial& from, std::size_t index, Material& to) {
    for (const MaterialExtension& extension : material_extension_readers()) {
      const auto it = from.extensions.find(extension.extension);
      if (it != from.extensions.end()) {
        ExtensionReader reader(
            it->second, path_ + ": materials[" + std::to_string(index) + "].extensions." + extension.extension,
            [this](const GltfTextureInfo& info, TextureUse use) { return texture(info, use); }, warnings_);
        extension.read(reader, to);
      }
    }
  }

  float unit(double value, const char* what) {
    if (value < 0 || value > 1) {
      warnings_.push_back(place_ + ": " + what + " " + std::to_string(value) + " is outside 0..1 and was clamped");
    }
    return static_cast<float>(std::clamp(value, 0.0, 1.0));
  }
  Vec3f emission(const Vec3f& value) {
    if (std::max({value.x, value.y, value.z}) > kMostLight) {
      warnings_.push_back(place_ + ": its emission is above 1e30, which is the most, and was clamped");
    }
    const auto channel = [](float x) { return std::clamp(x, 0.0F, kMostLight); };
    return {channel(value.x), channel(value.y), channel(value.z)};
  }

  AlphaMode alpha_mode(const std::string& name) {
    if (name == "MASK") {
      return AlphaMode::mask;
    }
    if (name == "BLEND") {
      return AlphaMode::blend;
    }
    if (name != "OPAQUE") {
      warnings_.push_back(place_ + ": alphaMode '" + name + "' does not exist; read as OPAQUE");
    }
    return AlphaMode::opaque;
  }

  TextureRef texture(const GltfTextureInfo& info, TextureUse use) {
    TextureRef ref;
    if (info.texture < 0) {
      return ref;
    }
    ref.texture = textures_.request(info.texture, use, warnings_);
    if (info.tex_coord > 1) {
      warnings_.push_back(place_ + ": TEXCOORD_" + std::to_string(info.tex_coord) +
                          " is not supported; the texture is read with TEXCOORD_0");
    }
    ref.uv_set = info.tex_coord == 1 ? 1 : 0;
    ref.transform = texture_matrix(info);
    ref.has_transform = ref.transform != TextureRef{}.transform;
    return ref;
  }

  const std::string& path_;
  TextureTable& textures_;
  Warnings& warnings_;
  std::string place_;
};

}  // namespace

std::vector<Material> make_materials(const GltfDocument& document, TextureTable& textures, Warnings& warnings) {
  MaterialBuilder builder(document.path, textures, warnings);
  std::vector<Material> materials;
  materials.reserve(document.materials.size() + 1);
  for (std::size_t i = 0; i < document.materials.size(); ++i) {
    materials.push_back(builder.build(document.materials[i], i));
  }
  return materials;
}

void drop_needless_alpha(const std::vector<Texture>& textures, const std::vector<Mesh>& meshes,
                         std::vector<Material>& materials) {
  std::vector<bool> has_clear_vertices(materials.size(), false);
  for (const Mesh& mesh : meshes) {
    for (const Geometry& geometry : mesh.geometries) {
      const auto is_clear = [](const Vec4f& color) { return color.w < 1; };
      const auto turns_clear = [](const MorphTarget& target) {
        return std::any_of(target.colors.begin(), target.colors.end(), [](const Vec4f& added) { return added.w != 0; });
      };
      if (std::any_of(geometry.colors.begin(), geometry.colors.end(), is_clear) ||
          std::any_of(geometry.morph_targets.begin(), geometry.morph_targets.end(), turns_clear)) {
        has_clear_vertices[static_cast<std::size_t>(geometry.material)] = true;
      }
    }
  }
  for (std::size_t i = 0; i < materials.size(); ++i) {
    Material& material = materials[i];
    const TextureRef& ref = material.base_color_texture;
    const bool varies =
        has_clear_vertices[i] || (ref.present() && textures[static_cast<std::size_t>(ref.texture)].has_alpha);
    const float least = material.alpha_mode == AlphaMode::mask ? material.alpha_cutoff : 1.0F;
    if (!varies && material.base_color.w >= least) {
      material.alpha_mode = AlphaMode::opaque;
    }
  }
}

VertexNeeds vertex_needs(const Material& material) {
  VertexNeeds needs;
  const auto add = [&needs](const TextureRef* ref) {
    if (ref->present()) {
      (ref->uv_set == 1 ? needs.uv1 : needs.uv0) = true;
    }
  };
  for (const TextureRef* ref : {&material.base_color_texture, &material.metallic_roughness_texture,
                                &material.normal_texture, &material.emissive_texture}) {
    add(ref);
  }
  for (const TextureRef* ref : layer_textures(material)) {
    add(ref);
  }
  needs.tangents = material.normal_texture.present() || material.clearcoat.normal_texture.present() ||
                   material.anisotropy.strength > 0;
  return needs;
}

}  // namespace gazetrace
