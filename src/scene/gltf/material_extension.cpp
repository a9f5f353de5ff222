// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/material_extension.hpp"

#include <algorithm>

#include "gazetrace/scene.hpp"

namespace gazetrace {

const std::vector<double>* ExtensionReader::numbers(const char* key, std::size_t count) const {
  const auto it = from_.numbers.find(key);
  const bool is_something_else = from_.others.contains(key) || from_.textures.contains(key);
  if (is_something_else || (it != from_.numbers.end() && it->second.size() != count)) {
    throw Error(
        ErrorKind::input, place_ + "." + key,
        count == 1 ? std::string("is not a number") : "is not an array of " + std::to_string(count) + " numbers",
        "export the file again");
  }
  return it == from_.numbers.end() ? nullptr : &it->second;
}

double ExtensionReader::in_range(const char* key, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    warnings_.push_back(place_ + "." + key + " " + std::to_string(value) + " is outside its range and was clamped");
    return value > high ? high : low;
  }
  return value;
}

float ExtensionReader::number(const char* key, double fallback, double low, double high) {
  const std::vector<double>* values = numbers(key, 1);
  return static_cast<float>(values == nullptr ? fallback : in_range(key, values->front(), low, high));
}

Vec3f ExtensionReader::color(const char* key, const Vec3f& fallback, double high) {
  const std::vector<double>* values = numbers(key, 3);
  if (values == nullptr) {
    return fallback;
  }
  return to_float(Vec3d{in_range(key, (*values)[0], 0, high), in_range(key, (*values)[1], 0, high),
                        in_range(key, (*values)[2], 0, high)});
}

Vec4f ExtensionReader::color_alpha(const char* key, const Vec4f& fallback) {
  const std::vector<double>* values = numbers(key, 4);
  if (values == nullptr) {
    return fallback;
  }
  const auto at = [&](std::size_t i) { return static_cast<float>(in_range(key, (*values)[i], 0, 1)); };
  return {at(0), at(1), at(2), at(3)};
}

TextureRef ExtensionReader::texture(const char* key, TextureUse use) {
  if (from_.others.contains(key) || from_.numbers.contains(key)) {
    throw Error(ErrorKind::input, place_ + "." + key, "is not a texture", "export the file again");
  }
  const auto it = from_.textures.find(key);
  return it == from_.textures.end() ? TextureRef{} : request_(it->second, use);
}

float ExtensionReader::texture_scale(const char* key) const {
  const auto it = from_.textures.find(key);
  return it == from_.textures.end() ? 1.0F : static_cast<float>(it->second.scale_factor);
}

const std::vector<MaterialExtension>& material_extension_readers() {
  static const std::vector<MaterialExtension> readers{
#define MATERIAL_EXTENSION(name, extension, description) {extension, read_##name},
#include "scene/gltf/material_extensions.def"
#undef MATERIAL_EXTENSION
  };
  return readers;
}

std::vector<MaterialExtensionInfo> material_extensions() {
  return {
#define MATERIAL_EXTENSION(name, extension, description) {extension, description},
#include "scene/gltf/material_extensions.def"
#undef MATERIAL_EXTENSION
  };
}

}  // namespace gazetrace
