// SPDX-License-Identifier: Apache-2.0
// The members of material_extensions.def read their fields with this. Error(input) with the place in the JSON for a
// field of the wrong type; a number outside its range is clamped with a warning.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/material.hpp"
#include "scene/gltf/document.hpp"
#include "scene/texture.hpp"

namespace gazetrace {

class ExtensionReader {
 public:
  using TextureRequest = std::function<TextureRef(const GltfTextureInfo&, TextureUse)>;

  // `place` ends in the extension's name.
  ExtensionReader(const GltfExtension& from, std::string place, TextureRequest request, Warnings& warnings)
      : from_(from), place_(std::move(place)), request_(std::move(request)), warnings_(warnings) {}

  [[nodiscard]] float number(const char* key, double fallback, double low = 0,
                             double high = std::numeric_limits<float>::max());
  [[nodiscard]] Vec3f color(const char* key, const Vec3f& fallback, double high = 1);
  [[nodiscard]] Vec4f color_alpha(const char* key, const Vec4f& fallback);
  [[nodiscard]] TextureRef texture(const char* key, TextureUse use);
  [[nodiscard]] float texture_scale(const char* key) const;  // normal maps

 private:
  const std::vector<double>* numbers(const char* key, std::size_t count) const;
  double in_range(const char* key, double value, double low, double high);

  const GltfExtension& from_;
  std::string place_;
  TextureRequest request_;
  Warnings& warnings_;
};

// One function `read_<name>` per line of material_extensions.def; `to` already has the metallic-roughness values.
#define MATERIAL_EXTENSION(name, extension, description) void read_##name(ExtensionReader& from, Material& to);
#include "scene/gltf/material_extensions.def"
#undef MATERIAL_EXTENSION

struct MaterialExtension {
  const char* extension;
  void (*read)(ExtensionReader& from, Material& to);
};
const std::vector<MaterialExtension>& material_extension_readers();

}  // namespace gazetrace
