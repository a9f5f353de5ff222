// SPDX-License-Identifier: Apache-2.0
// KHR_materials_anisotropy.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_anisotropy(ExtensionReader& from, Material& to) {
  to.anisotropy.strength = from.number("anisotropyStrength", 0, 0, 1);
  to.anisotropy.rotation_rad =
      from.number("anisotropyRotation", 0, std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max());
  if (to.anisotropy.strength > 0) {
    to.anisotropy.texture = from.texture("anisotropyTexture", TextureUse::data);
  }
}

}  // namespace gazetrace
